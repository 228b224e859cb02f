#include "window_match.hpp"

#include "topogeo/matching/match_gate.hpp"

namespace topogeo::localization {

StopMatch window_match(const PoseGraph& graph, std::uint32_t stop, const PlaceProposal& place,
                       const CovarianceCalibration& calibration) {
  // The match places the whole window; the stop follows by its pose relative to the first stop of
  // the window, with the uncertainty of that pose.
  const UncertainPose T_first_stop = graph.along_path(place.first_of_query, stop);
  const Eigen::Matrix3d within =
      compose({place.aligned.T_a_b * geometry::inverse(T_first_stop.T_a_b)}, T_first_stop)
          .covariance;
  const Eigen::Matrix3d covariance = place.aligned.covariance + within;
  StopMatch match;
  match.edge = {place.anchor,       stop,
                EdgeKind::kRevisit, place.aligned.T_a_b,
                covariance,         calibration.of_match(place.aligned.covariance) + within};
  match.T_later_earlier = inverse({place.aligned.T_a_b, covariance});
  match.predicted = place.predicted;
  match.source = ProposalSource::kWindow;
  match.first_of_window = place.first_of_query;
  match.reason = Reason::kDoubtful;
  match.fitness = place.value;
  match.overlap = place.seen;
  match.weakest_sigma_m = localization::weakest_sigma_m(covariance);
  return match;
}

}  // namespace topogeo::localization
