// The topics of topogeo: their names, types and roles. A role names the QoS profiles
// (<role>_writer, <role>_reader) of deploy/dds_profiles.xml.
//
// Names carry the version of the wire contract (idl/): a change of a type is a new name, so that
// peers of different versions do not see each other's messages.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace eprosima::fastdds::dds {
class TopicDataType;
}

namespace topogeo::msg {
class Scan;
class Odometry;
class Sonar;
class BaseStatus;
class LaserStatus;
class StreamEnd;
class LocalMap;
class TrackedPose;
class MatchTask;
class MatchResult;
class MapRequest;
class MapCopy;
class WorkerStatus;
class ServiceStatus;
class LivePose;
class TrajectorySegment;
class LoopClosures;
class LoopDecisions;
class LocalizationCommand;
class LocalizationReply;
class MapElement;
class Goal;
class Route;
class Blockages;
class NavigatorStatus;
class GridTile;
class HybridMap;
class MotionCommand;
class BaseCommand;
class GroundTruth;
class SimulatorCommand;
}  // namespace topogeo::msg

namespace topogeo::messaging {

inline constexpr std::string_view kScan = "topogeo/v6/scan";
inline constexpr std::string_view kOdometry = "topogeo/v6/odometry";
inline constexpr std::string_view kSonar = "topogeo/v6/sonar";
inline constexpr std::string_view kBaseStatus = "topogeo/v6/base_status";
inline constexpr std::string_view kLaserStatus = "topogeo/v6/laser_status";
inline constexpr std::string_view kStreamEnd = "topogeo/v6/stream_end";
inline constexpr std::string_view kLocalMap = "topogeo/v6/local_map";
inline constexpr std::string_view kTrackedPose = "topogeo/v6/tracked_pose";
inline constexpr std::string_view kMatchTask = "topogeo/v6/match_task";
inline constexpr std::string_view kMatchResult = "topogeo/v6/match_result";
inline constexpr std::string_view kMapRequest = "topogeo/v6/map_request";
inline constexpr std::string_view kMapCopy = "topogeo/v6/map_copy";
inline constexpr std::string_view kWorkerStatus = "topogeo/v6/worker_status";
inline constexpr std::string_view kServiceStatus = "topogeo/v6/service_status";
inline constexpr std::string_view kLivePose = "topogeo/v6/pose";
inline constexpr std::string_view kTrajectorySegment = "topogeo/v6/trajectory";
inline constexpr std::string_view kLoopClosures = "topogeo/v6/loop_closures";
inline constexpr std::string_view kLoopDecisions = "topogeo/v6/loop_decisions";
inline constexpr std::string_view kLocalizationCommand = "topogeo/v6/localization_command";
inline constexpr std::string_view kLocalizationReply = "topogeo/v6/localization_reply";
inline constexpr std::string_view kMapElement = "topogeo/v6/map";
inline constexpr std::string_view kGoal = "topogeo/v6/goal";
inline constexpr std::string_view kRoute = "topogeo/v6/route";
inline constexpr std::string_view kBlockages = "topogeo/v6/blockages";
inline constexpr std::string_view kNavigatorStatus = "topogeo/v6/navigator_status";
inline constexpr std::string_view kGridTile = "topogeo/v6/grid_tile";
inline constexpr std::string_view kHybridMap = "topogeo/v6/hybrid_map";
inline constexpr std::string_view kMotionCommand = "topogeo/v6/motion_command";
inline constexpr std::string_view kBaseCommand = "topogeo/v6/base_command";
inline constexpr std::string_view kGroundTruth = "topogeo/v6/ground_truth";
inline constexpr std::string_view kSimulatorCommand = "topogeo/v6/simulator_command";

/// Role of the sensor topics while a log is replayed: a slow reader slows the writer. Writer and
/// readers of a run must agree on it.
inline constexpr std::string_view kReplayRole = "sensor_replay";

/// What the library has to know of a topic and its type.
struct TopicInfo {
  std::string_view name;
  std::string_view role;         ///< profiles in normal operation
  std::string_view replay_role;  ///< profiles while a log is replayed; empty: same as `role`
  /// Field that says whom a message is for: the first one after those that all messages start with;
  /// empty: for everybody.
  std::string_view addressee;

  /// Makes the type support; the caller owns it.
  eprosima::fastdds::dds::TopicDataType* (*make_type)();
  /// Why a message of this type must not travel: another schema version or a sequence over its
  /// bound. The generated code checks neither.
  std::optional<std::string> (*find_defect)(const void* message);
};

/// TopicTraits<T>::info() for each message type that has a topic.
template <class T>
struct TopicTraits {
  static const TopicInfo& info();
};

/// All topics, ascending by name.
std::span<const TopicInfo* const> all_topics();

}  // namespace topogeo::messaging
