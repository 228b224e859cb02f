// Pose of the view of the last metres within a recognized place.
#pragma once

#include <cstdint>

#include "topogeo/slam/place_recognition.hpp"
#include "topogeo/slam/pose_graph.hpp"

#include "covariance_calibration.hpp"
#include "loop/stop_match.hpp"

namespace topogeo::localization {

/// An aligned proposal as a doubtful match of the stop with the anchor of the place: it closes a
/// loop only together with others that agree.
StopMatch window_match(const PoseGraph& graph, std::uint32_t stop, const PlaceProposal& place,
                       const CovarianceCalibration& calibration);

}  // namespace topogeo::localization
