// Messages to what a navigator works with and back; the rules of conversions.hpp hold.
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
/// The pose of a navigator's Markov localization. One that is not tracked means nothing.
LivePose to_live_pose(const navigation::PoseFix& fix, std::uint64_t sequence);

navigation::OdometrySample odometry_from_msg(const msg::Odometry& message);

/// The points where the beams of a scan ended. `T_robot_laser`: mounting of the laser.
navigation::ScanPoints to_scan_points(const scan::Scan& scan, const geometry::Pose2& T_robot_laser);

/// Refuses ranges that are negative or no finite numbers and cones that are not within (0, pi].
navigation::SonarRound sonar_from_msg(const msg::Sonar& message);

navigation::BaseCondition base_from_msg(const msg::BaseStatus& message);

msg::NavigatorStatus to_msg(const navigation::NavigatorStatus& status, std::string_view robot_id,
                            std::int64_t stamp_ns, std::uint64_t sequence_number);
/// Commands the speeds `linear_mps` and `angular_radps`.
navigation::NavigatorStatus from_msg(const msg::NavigatorStatus& message);

/// Throws std::invalid_argument for more points than a message takes (4,096).
msg::Blockages to_msg(const navigation::BlockageReport& report, std::string_view robot_id,
                      std::int64_t stamp_ns, std::uint64_t sequence_number);
navigation::BlockageReport from_msg(const msg::Blockages& message);

}  // namespace topogeo::service
