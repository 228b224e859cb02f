// Checks that the generated code leaves out: schema version and bounds of sequences.
#pragma once

#include <optional>
#include <string>

#include "topogeo/msg/hybrid_map.h"
#include "topogeo/msg/local_map.h"
#include "topogeo/msg/map_update.h"
#include "topogeo/msg/match.h"
#include "topogeo/msg/motion.h"
#include "topogeo/msg/planning.h"
#include "topogeo/msg/sensor.h"
#include "topogeo/msg/simulation.h"
#include "topogeo/msg/status.h"
#include "topogeo/msg/stream.h"
#include "topogeo/msg/trajectory.h"

namespace topogeo::messaging {

using Defect = std::optional<std::string>;

/// Why a message must not travel; empty when it may.
Defect find_defect(const msg::Scan& message);
Defect find_defect(const msg::Odometry& message);
Defect find_defect(const msg::Sonar& message);
Defect find_defect(const msg::BaseStatus& message);
Defect find_defect(const msg::LaserStatus& message);
Defect find_defect(const msg::StreamEnd& message);
Defect find_defect(const msg::LocalMap& message);
Defect find_defect(const msg::TrackedPose& message);
Defect find_defect(const msg::MatchTask& message);
Defect find_defect(const msg::MatchResult& message);
Defect find_defect(const msg::MapRequest& message);
Defect find_defect(const msg::MapCopy& message);
Defect find_defect(const msg::WorkerStatus& message);
Defect find_defect(const msg::ServiceStatus& message);
Defect find_defect(const msg::LivePose& message);
Defect find_defect(const msg::TrajectorySegment& message);
Defect find_defect(const msg::LoopClosures& message);
Defect find_defect(const msg::LoopDecisions& message);
Defect find_defect(const msg::LocalizationCommand& message);
Defect find_defect(const msg::LocalizationReply& message);
Defect find_defect(const msg::MapElement& message);
Defect find_defect(const msg::Goal& message);
Defect find_defect(const msg::Route& message);
Defect find_defect(const msg::Blockages& message);
Defect find_defect(const msg::NavigatorStatus& message);
Defect find_defect(const msg::GridTile& message);
Defect find_defect(const msg::HybridMap& message);
Defect find_defect(const msg::MotionCommand& message);
Defect find_defect(const msg::BaseCommand& message);
Defect find_defect(const msg::GroundTruth& message);
Defect find_defect(const msg::SimulatorCommand& message);

}  // namespace topogeo::messaging
