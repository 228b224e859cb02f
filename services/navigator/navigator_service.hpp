// Takes goals, routes, pose and sensor data; publishes motion commands, its status, the blockages
// on its path and, with Markov localization, the pose of the robot.
//
// Time is that of the sensors' stamps, see StampClock. Commands go out twenty times a second while
// the robot drives to a goal, and zeros for a second after that; then nothing, so that others may
// drive. A goal belongs to the robot and not to the client that gave it: it survives the client
// until it is reached, cancelled or replaced. A goal that has ended, or that was given before the
// navigator was connected with its client, is not driven unless it is ordered anew.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/motion.h"
#include "topogeo/msg/planning.h"
#include "topogeo/msg/sensor.h"
#include "topogeo/msg/trajectory.h"
#include "topogeo/navigation/navigator.hpp"
#include "topogeo/service/live_hybrid_map.hpp"
#include "topogeo/service/service.hpp"
#include "topogeo/service/stamp_clock.hpp"

#include "goal_memory.hpp"
#include "operator_stop_input.hpp"

namespace topogeo::navigator {

/// Lives in the loop of its service.
class NavigatorService {
 public:
  /// Keeps its goal in the file `memory` to continue it after a restart, and an operator's stop in
  /// the file `stop_memory` (each empty: none). Throws std::invalid_argument for a configuration
  /// out of range, std::runtime_error when a file cannot be made.
  NavigatorService(service::Service& service, const std::filesystem::path& memory,
                   const std::filesystem::path& stop_memory);
  NavigatorService(const NavigatorService&) = delete;
  NavigatorService& operator=(const NavigatorService&) = delete;
  /// Sends a command to stand still.
  ~NavigatorService();

 private:
  enum class Source : std::uint8_t { kPose, kOdometry, kScan, kSonar, kBase, kLaser };
  static constexpr std::size_t kSources = static_cast<std::size_t>(Source::kLaser) + 1;

  void listen_to_orders();
  void listen_to_sensors();
  void on_goal(const msg::Goal& message);
  void on_route(const msg::Route& message);
  /// Hands a route to the navigator, which ignores one for another goal.
  void use_route(const msg::Route& message);
  void on_scan(const msg::Scan& message);
  void take_map();
  /// False, and counted, for a message that is not newer than the one before or that is ahead of
  /// the clock, which scans and odometry set.
  bool is_newer(Source source, std::int64_t stamp_ns);
  /// False for late messages of the previous odometry epoch. Another epoch starts the navigator
  /// over, because poses carried on by the previous odometry are wrong.
  bool is_of_epoch(std::uint64_t epoch);
  /// Notes the delay of a message, for the reason of a halt.
  void note_arrival(navigation::TimedInput input, std::int64_t stamp_ns);
  /// Sets the clock by a message that has just arrived.
  void note_stamp(std::int64_t stamp_ns);

  /// Restores the goal of the previous run, which its client may not send again.
  void resume();
  void remember();
  void tick();
  /// Starts over with the current goal, because the inputs so far do not fit the new ones.
  void begin_again(const std::string& fault, const std::string& detail);
  /// Restores the arrival and its pause in a navigator that has just begun.
  void stay_arrived(const navigation::NavigatorStatus& before);
  void command(const geometry::Velocity& velocity, std::int64_t now_ns);
  void send_command(const geometry::Velocity& velocity, std::int64_t now_ns);
  /// Publishes the pose of Markov localization, the only one that planner and people have then.
  void publish_pose();
  void publish_status(std::int64_t now_ns);
  void publish_blockages(std::int64_t now_ns);

  service::Service& service_;
  service::StampClock clock_;
  navigation::Navigator navigator_;
  std::shared_ptr<const planning::HybridMap> map_;

  std::optional<navigation::GoalOrder> goal_;
  bool paused_ = false;
  GoalMemory memory_;
  OperatorStopInput stop_;
  std::optional<msg::Route> route_;  // the newest one
  std::array<std::optional<std::int64_t>, kSources> last_ns_;
  std::optional<std::uint64_t> epoch_;           // of the odometry
  std::optional<std::uint64_t> previous_epoch_;  // the one before
  std::int64_t epoch_since_ns_ = 0;              // by the steady clock

  std::int64_t command_until_ns_ = 0;  // by the steady clock: zeros are sent until then
  bool moving_ = false;                // the last command was not a standstill
  std::uint64_t commands_sent_ = 0;
  std::uint64_t statuses_sent_ = 0;
  std::uint64_t blockages_sent_ = 0;
  std::int64_t status_due_ns_ = 0;     // by the steady clock
  std::int64_t blockages_due_ns_ = 0;  // the same
  std::optional<navigation::NavigatorStatus> published_;
  std::string shown_stop_;  // in the state of the service, where `published_` has none
  std::optional<std::uint64_t> published_blockages_;

  service::LiveHybridMap live_map_;
  messaging::Writer<msg::MotionCommand> commands_;
  messaging::Writer<msg::NavigatorStatus> statuses_;
  messaging::Writer<msg::Blockages> blockages_;
  std::optional<messaging::Writer<msg::LivePose>> poses_;  // with Markov localization
  std::int64_t published_pose_ns_ = 0;
  std::uint64_t poses_sent_ = 0;
};

}  // namespace topogeo::navigator
