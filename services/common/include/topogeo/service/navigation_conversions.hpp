// Conversions between messages and the navigator's types; the rules of conversions.hpp hold.
#pragma once

#include <cstdint>
#include <string_view>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/msg/planning.h"
#include "topogeo/msg/sensor.h"
#include "topogeo/navigation/navigator_inputs.hpp"
#include "topogeo/service/conversions.hpp"

namespace topogeo::service {

navigation::PoseFix to_pose_fix(const LivePose& pose);
/// The pose from a navigator's Markov localization; meaningless unless it is tracked.
LivePose to_live_pose(const navigation::PoseFix& fix, std::uint64_t sequence);

navigation::OdometrySample odometry_from_msg(const msg::Odometry& message);

/// The end points of a scan's beams. `T_robot_laser`: mounting of the laser.
navigation::ScanPoints to_scan_points(const scan::Scan& scan, const geometry::Pose2& T_robot_laser);

/// Rejects ranges that are negative or not finite and cones that are not within (0, pi].
navigation::SonarRound sonar_from_msg(const msg::Sonar& message);

navigation::BaseCondition base_from_msg(const msg::BaseStatus& message);

msg::NavigatorStatus to_msg(const navigation::NavigatorStatus& status, std::string_view robot_id,
                            std::int64_t stamp_ns, std::uint64_t sequence_number);
/// Commands the speeds `linear_mps` and `angular_radps`.
navigation::NavigatorStatus from_msg(const msg::NavigatorStatus& message);
/// The goal of the status, if any, was reached or cancelled: no route to it is needed any more.
bool goal_has_ended(const msg::NavigatorStatus& message);

/// Throws std::invalid_argument when there are more points than a message holds (4,096).
msg::Blockages to_msg(const navigation::BlockageReport& report, std::string_view robot_id,
                      std::int64_t stamp_ns, std::uint64_t sequence_number);
navigation::BlockageReport from_msg(const msg::Blockages& message);

}  // namespace topogeo::service
