#include "topogeo/slam/place_recognition.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/matching/expected_overlap.hpp"
#include "topogeo/matching/match_gate.hpp"
#include "topogeo/matching/refinement.hpp"

namespace topogeo::localization {

using geometry::Pose2;

namespace {

constexpr double kSubmap_m = 8.0;  // of path; each begins half its length after the previous one
constexpr double kQueryLeast_m = 2.5;
constexpr std::size_t kQueryPoints = 120;
constexpr double kQuerySpacing_m = 0.20;
constexpr double kSigmas = 3.0;  // of the prediction, to search
// Wider than the prediction, because queries follow failed matches by prediction: an earlier step
// may have been wrong.
constexpr double kWider = 1.5;
const Eigen::Matrix3d kSurprise = Eigen::Vector3d(0.09, 0.09, 0.01).asDiagonal();
constexpr double kWidestWindow_m = 12.0;  // limit of the search to each side
constexpr double kFootprint_m = 10.0;     // from a submap's anchor to positions that see it
// Bounds the time of a step in any map: only the most likely submaps are searched.
constexpr std::size_t kMostSubmaps = 40;
constexpr double kLeastScore = 0.30;
constexpr std::size_t kPlacesOfSubmap = 3;  // to compare
// For the comparison as a whole: spacing of the points, and limits. A point is there if the submap
// has one within kThere_m, and contradicts it if a stop of the submap saw past it.
constexpr double kAlignedSpacing_m = 0.10;
constexpr std::size_t kAlignedPoints = 400;
constexpr double kSubmapSpacing_m = 0.05;
constexpr std::size_t kSubmapPoints = 6000;
constexpr double kThere_m = 0.20;
constexpr double kPlaceTolerance_m = 0.35;
constexpr double kUsualDoubt = 1.0;
// Weak prior for directions without information, as along a bare corridor: half a metre, 6 degrees.
const Eigen::Matrix3d kWeak = Eigen::Vector3d(4.0, 4.0, 100.0).asDiagonal();
constexpr double kLeastSeen = 0.35;

// One point per square, in the order of the squares; at most about `count` of them.
std::vector<SurfacePoint> thinned(std::vector<SurfacePoint> points, double spacing_m,
                                  std::size_t count) {
  const auto cell = [&](const SurfacePoint& p) {
    return std::pair(static_cast<std::int64_t>(std::floor(p.position_m.y() / spacing_m)),
                     static_cast<std::int64_t>(std::floor(p.position_m.x() / spacing_m)));
  };
  std::stable_sort(points.begin(), points.end(),
                   [&](const SurfacePoint& a, const SurfacePoint& b) { return cell(a) < cell(b); });
  points.erase(
      std::unique(points.begin(), points.end(),
                  [&](const SurfacePoint& a, const SurfacePoint& b) { return cell(a) == cell(b); }),
      points.end());
  if (points.size() <= count) return points;
  std::vector<SurfacePoint> some;
  for (std::size_t i = 0; i < count; ++i) some.push_back(points[i * points.size() / count]);
  return some;
}

std::vector<Eigen::Vector2d> positions(std::span<const SurfacePoint> points) {
  std::vector<Eigen::Vector2d> out;
  for (const SurfacePoint& p : points) out.push_back(p.position_m);
  return out;
}

bool better(const PlaceProposal& a, const PlaceProposal& b) {
  return a.value * a.seen > b.value * b.seen;
}

}  // namespace

PlaceQuery::PlaceQuery(std::vector<SurfacePoint> seen) {
  whole.surface = thinned(std::move(seen), kAlignedSpacing_m, kAlignedPoints);
  coarse_m = positions(thinned(whole.surface, kQuerySpacing_m, kQueryPoints));
}

Eigen::Matrix3d widened_for_places(const Eigen::Matrix3d& predicted) {
  return predicted * (kWider * kWider) + kSurprise;
}

StopView view_of(MatchFeatures features) {
  StopView view;
  view.outline = outline_of(features.coarse);
  for (const SurfacePoint& point : features.coarse) {
    if (point.position_m.squaredNorm() <= StopView::kNear_m * StopView::kNear_m) {
      view.near.push_back(point);
    }
  }
  view.profile = std::move(features.profile);
  return view;
}

void PlaceRecognition::add(std::shared_ptr<const StopView> view, double path_m) {
  views_.push_back(std::move(view));
  path_m_.push_back(path_m);
}

void PlaceRecognition::add_submap(std::span<const Pose2> T_map_stop, std::uint32_t first,
                                  std::uint32_t last) {
  Submap submap{first, last, (first + last) / 2, {}, {}};
  for (std::uint32_t stop = first; stop <= last; ++stop) {
    submap.T_anchor_stop.push_back(geometry::between(T_map_stop[submap.anchor], T_map_stop[stop]));
    submap.T_stop_anchor.push_back(geometry::inverse(submap.T_anchor_stop.back()));
  }
  submaps_.push_back(std::move(submap));
}

// Completes submaps whose stops are all older than the recent ones.
void PlaceRecognition::cut(std::span<const Pose2> T_map_stop, std::uint32_t first_recent) {
  while (true) {
    std::uint32_t last = next_first_;
    while (last + 1 < first_recent && path_m_[last] - path_m_[next_first_] < kSubmap_m) ++last;
    if (last >= first_recent || path_m_[last] - path_m_[next_first_] < kSubmap_m) return;
    add_submap(T_map_stop, next_first_, last);
    const double begin_m = path_m_[next_first_];
    while (next_first_ < last && path_m_[next_first_] - begin_m < 0.5 * kSubmap_m) ++next_first_;
  }
}

std::vector<SurfacePoint> PlaceRecognition::points_of(const Submap& submap) const {
  std::vector<SurfacePoint> points;
  for (std::uint32_t stop = submap.first; stop <= submap.last; ++stop) {
    add_moved(views_[stop]->near, submap.T_anchor_stop[stop - submap.first], points);
  }
  return thinned(std::move(points), kSubmapSpacing_m, kSubmapPoints);
}

// View of the last metres up to a stop, in its frame. Ends at an uncertain step, because the view
// before it would be found without any information about the stop.
PlaceRecognition::Query PlaceRecognition::query(const PoseGraph& graph, std::uint32_t stop) const {
  Query query;
  for (std::uint32_t i = stop + 1; i-- > 0;) {
    if (path_m_[stop] - path_m_[i] > kQuery_m) break;
    const UncertainPose T_stop_i = graph.along_path(stop, i);
    if (!well_known(T_stop_i.covariance)) break;
    add_moved(views_[i]->near, T_stop_i.T_a_b, query.points);
    query.first_stop = i;
  }
  return query;
}

const CoarseMap& PlaceRecognition::map_of(std::size_t submap) {
  return maps_.get(submap, [&] { return CoarseMap(positions(points_of(submaps_[submap]))); });
}

const Reference& PlaceRecognition::reference_of(std::size_t submap) {
  return references_.get(submap, [&] {
    MatchFeatures features;
    features.surface = points_of(submaps_[submap]);
    return make_reference(std::move(features));
  });
}

// Aligns the whole view of the last metres with the submap.
void PlaceRecognition::align_with(std::size_t submap, const MatchFeatures& query,
                                  PlaceProposal& proposal) {
  const Reference& reference = reference_of(submap);
  const PosePrior weak{proposal.T_anchor_robot, kWeak};
  proposal.T_anchor_robot =
      align(reference, query, proposal.T_anchor_robot, weak).T_reference_query;
  count_seen(submaps_[submap], reference, query, proposal);
  const Pose2& T = proposal.T_anchor_robot;
  const Eigen::Matrix3d information = information_at(reference, query, T);
  if (!information.isZero(0.0)) proposal.aligned = {T, match_covariance(information, kUsualDoubt)};
}

// Counts the query points that the submap contains, among those that its stops could see.
void PlaceRecognition::count_seen(const Submap& submap, const Reference& reference,
                                  const MatchFeatures& query, PlaceProposal& proposal) const {
  std::vector<geometry::SinCos> turns;
  for (const Pose2& T_stop_anchor : submap.T_stop_anchor) {
    turns.push_back(geometry::sincos(T_stop_anchor.theta_rad));
  }
  const Pose2& T = proposal.T_anchor_robot;
  const geometry::SinCos heading = geometry::sincos(T.theta_rad);
  std::size_t there = 0;
  std::size_t contradicted = 0;
  for (const SurfacePoint& point : query.surface) {
    const SurfacePoint p = moved(point, T, heading);
    const std::int32_t found = reference.surface_grid.find(p.position_m.x(), p.position_m.y());
    if (found != NearestPointGrid::kNone &&
        (reference.features->surface[static_cast<std::size_t>(found)].position_m - p.position_m)
                .squaredNorm() <= kThere_m * kThere_m) {
      ++there;
      continue;
    }
    for (std::size_t i = 0; i < turns.size(); ++i) {
      const SurfacePoint q = moved(p, submap.T_stop_anchor[i], turns[i]);
      const auto view =
          views_[submap.first + i]->profile.view_of_face(q.position_m, q.normal, kPlaceTolerance_m);
      if (view != RangeProfile::View::kFree) continue;
      ++contradicted;
      break;
    }
  }
  const auto seen = static_cast<double>(there + contradicted);
  proposal.seen = seen / static_cast<double>(std::max<std::size_t>(1, query.surface.size()));
  proposal.value = seen > 0.0 ? static_cast<double>(there) / seen : 0.0;
}

/// A submap that the robot may be in.
struct PlaceRecognition::Target {
  std::size_t submap = 0;
  CoarseWindow window;
  UncertainPose predicted;
  double distance = 0.0;  // squared deviations beyond the footprint
};

// Sorted, most likely submaps first.
std::vector<PlaceRecognition::Target> PlaceRecognition::targets(
    std::uint32_t first_recent, std::span<const UncertainPose> relative,
    double least_sigma_m) const {
  std::vector<Target> targets;
  for (std::size_t i = 0; i < submaps_.size(); ++i) {
    const Submap& submap = submaps_[i];
    if (submap.last >= first_recent) break;
    const UncertainPose T_anchor_robot = inverse(relative[submap.anchor]);
    const Eigen::Matrix3d& known = T_anchor_robot.covariance;
    if (std::max(known(0, 0), known(1, 1)) < least_sigma_m * least_sigma_m) continue;
    const Eigen::Matrix3d c = widened_for_places(T_anchor_robot.covariance);
    Eigen::Vector3d half =
        kSigmas * Eigen::Vector3d(std::sqrt(c(0, 0)), std::sqrt(c(1, 1)), std::sqrt(c(2, 2)));
    const Eigen::Vector2d centre = T_anchor_robot.T_a_b.position_m();
    const double beyond_x = std::max(0.0, std::fabs(centre.x()) - kFootprint_m);
    const double beyond_y = std::max(0.0, std::fabs(centre.y()) - kFootprint_m);
    if (beyond_x > half.x() || beyond_y > half.y()) continue;
    const double distance = beyond_x * beyond_x / c(0, 0) + beyond_y * beyond_y / c(1, 1);
    // Positions beyond the footprint are not searched, because the submap is not in view from
    // there.
    CoarseWindow window{T_anchor_robot.T_a_b, half};
    for (const int axis : {0, 1}) {
      const double low = std::max(centre[axis] - half[axis], -kFootprint_m);
      const double high = std::min(centre[axis] + half[axis], kFootprint_m);
      (axis == 0 ? window.centre.x_m : window.centre.y_m) = 0.5 * (low + high);
      window.half_width[axis] = std::min(0.5 * (high - low), kWidestWindow_m);
    }
    window.half_width.z() = std::min(half.z(), std::numbers::pi);
    targets.push_back({i, window, T_anchor_robot, distance});
  }
  std::stable_sort(targets.begin(), targets.end(),
                   [](const Target& a, const Target& b) { return a.distance < b.distance; });
  if (targets.size() > kMostSubmaps) targets.resize(kMostSubmaps);
  return targets;
}

// Places in a submap that still differ after alignment, best first. All are returned: the one with
// most in view is often a place along the corridor, where less of the query lies beyond the submap.
std::vector<PlaceProposal> PlaceRecognition::places_in(const Target& target,
                                                       const PlaceQuery& query) {
  std::vector<PlaceProposal> found;
  for (const CoarseMatch& match : search_coarsely(map_of(target.submap), query.coarse_m,
                                                  target.window, kLeastScore, kPlacesOfSubmap)) {
    PlaceProposal proposal = proposal_in(target.submap, match.T_map_points);
    proposal.predicted = target.predicted;
    align_with(target.submap, query.whole, proposal);
    if (proposal.seen >= kLeastSeen) found.push_back(proposal);
  }
  std::stable_sort(found.begin(), found.end(), better);
  std::vector<PlaceProposal> places;
  for (const PlaceProposal& proposal : found) {
    const bool known = std::any_of(places.begin(), places.end(), [&](const PlaceProposal& other) {
      return same_place(other.T_anchor_robot, proposal.T_anchor_robot);
    });
    if (!known) places.push_back(proposal);
  }
  return places;
}

PlaceProposal PlaceRecognition::proposal_in(std::size_t submap, const Pose2& T_anchor_robot) const {
  PlaceProposal proposal;
  proposal.anchor = submaps_[submap].anchor;
  proposal.first_stop = submaps_[submap].first;
  proposal.last_stop = submaps_[submap].last;
  proposal.T_anchor_robot = T_anchor_robot;
  return proposal;
}

std::vector<PlaceProposal> PlaceRecognition::propose(const PoseGraph& graph, std::uint32_t stop,
                                                     std::uint32_t first_recent,
                                                     std::span<const UncertainPose> relative,
                                                     double least_sigma_m) {
  cut(graph.poses(), first_recent);
  std::vector<PlaceProposal> found;
  if (path_m_[stop] - path_m_.front() < kQueryLeast_m) return found;
  const std::vector<Target> likely = targets(first_recent, relative, least_sigma_m);
  if (likely.empty()) return found;
  const Query seen = query(graph, stop);
  const PlaceQuery asked(seen.points);
  for (const Target& target : likely) {
    for (PlaceProposal& place : places_in(target, asked)) {
      place.first_of_query = seen.first_stop;
      found.push_back(std::move(place));
    }
  }
  std::stable_sort(found.begin(), found.end(), better);
  return found;
}

}  // namespace topogeo::localization
