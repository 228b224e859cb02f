// Where all that was seen over the last metres lies in a place that was recognized.
#pragma once

#include <cstdint>

#include "topogeo/localization/mapping/covariance_calibration.hpp"
#include "topogeo/localization/mapping/pose_graph.hpp"
#include "topogeo/localization/mapping/stop_match.hpp"
#include "topogeo/localization/places/place_recognition.hpp"

namespace topogeo::localization {

/// Of an aligned proposal, as a doubtful match of the stop with the anchor of the place: only with
/// others that agree does it close a loop.
StopMatch window_match(const PoseGraph& graph, std::uint32_t stop, const PlaceProposal& place,
                       const CovarianceCalibration& calibration);

}  // namespace topogeo::localization
