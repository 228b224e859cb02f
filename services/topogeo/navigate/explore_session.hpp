// Explores the floor around a robot: follows the growing map and sends the robot from target to
// target.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "topogeo/map_client/map_follower.hpp"
#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/msg/map_update.h"
#include "topogeo/msg/trajectory.h"
#include "topogeo/navigation/exploration_tour.hpp"
#include "topogeo/service/trajectory_assembly.hpp"
#include "topogeo/supervision/goal_progress.hpp"

#include "navigate/goal_client.hpp"

namespace topogeo::cli {

class ExploreSession {
 public:
  /// Must be used in the loop only. Throws like GoalClient.
  ExploreSession(const messaging::Participant& participant, messaging::EventLoop& loop,
                 const std::string& robot_id, const navigation::TourConfig& config);

  [[nodiscard]] GoalClient& client() { return client_; }

  /// Takes a changed map, sends the next goal, shows progress. Call it about ten times a second.
  /// Throws std::runtime_error when a goal cannot be sent.
  void tick();

  [[nodiscard]] bool done() const { return tour_.done(); }
  /// The lasting reason why the robot cannot explore; empty if it can.
  [[nodiscard]] std::string trouble() const;
  /// A final line: targets, metres, abandoned targets.
  [[nodiscard]] std::string summary() const;
  /// The map and the driven path as a picture (.png or .svg). Throws std::runtime_error when it
  /// cannot be written.
  void write_picture(const std::filesystem::path& file) const;

 private:
  void listen(messaging::EventLoop& loop);
  void take_map();
  void record_path();
  [[nodiscard]] navigation::NavigatorStatus navigator() const;
  /// Whether an operator has paused the goal, because another goal would end the pause.
  [[nodiscard]] bool paused() const {
    return client_.taken() && client_.status()->reason == navigation::HaltReason::kPaused;
  }
  [[nodiscard]] bool is_own(const auto& message) const {
    return message.robot_id() == robot_id_.c_str();
  }

  std::string robot_id_;
  GoalClient client_;
  supervision::GoalProgress progress_;
  navigation::ExplorationTour tour_;
  map_client::MapFollower follower_;
  service::TrajectoryAssembly trajectory_;
  bool graph_changed_ = false;
  std::shared_ptr<const topomap::GlobalMap> graph_;
  std::shared_ptr<const planning::HybridMap> map_;
  std::uint64_t goal_id_ = 0;  // number given by the tour
  std::int64_t ticked_ns_ = 0;
  std::int64_t paused_ns_ = 0;  // time of the pause, which does not count
  std::optional<msg::LivePose> pose_;
  std::vector<Eigen::Vector2d> path_m_;  // map frame
  double driven_m_ = 0.0;

  messaging::Reader<msg::MapElement> elements_;
  messaging::Reader<msg::TrajectorySegment> segments_;
  messaging::Reader<msg::LivePose> poses_;
};

}  // namespace topogeo::cli
