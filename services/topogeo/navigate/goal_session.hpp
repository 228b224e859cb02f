// A goal from the command line: waits for the services, sends the goal, shows the robot's progress
// and draws the route.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/render/picture_format.hpp"
#include "topogeo/supervision/goal_progress.hpp"

#include "navigate/goal_client.hpp"

namespace topogeo::cli {

struct GoalOptions {
  std::string target;                            ///< X,Y, #NODE or the name of a place
  std::optional<double> heading_deg;             ///< map frame
  bool look_around = false;                      ///< see msg::Goal
  std::optional<std::filesystem::path> picture;  ///< file for the picture of the route
  double patience_s = 60.0;                      ///< see supervision::GoalWatch
};

/// Adds --heading, --look-around, --picture and --patience.
void add_goal_options(command_line::Command& app, GoalOptions& options);

/// Throws service::UsageError for an unknown picture format.
void check_picture(const std::optional<std::filesystem::path>& picture);

/// Throws service::UsageError for an invalid target or picture.
service::Goal to_goal(const GoalOptions& options);

class GoalSession {
 public:
  /// Lives in the loop. Throws like GoalClient and to_goal.
  GoalSession(const messaging::Participant& participant, messaging::EventLoop& loop,
              const std::string& robot_id, GoalOptions options);

  [[nodiscard]] GoalClient& client() { return client_; }
  [[nodiscard]] supervision::GoalProgress& progress() { return progress_; }

  void send();
  /// Shows progress and draws the route once it is known. Call it about ten times a second. Throws
  /// std::runtime_error when the picture cannot be written.
  void tick();
  /// End of the goal; nothing while it may still be reached.
  [[nodiscard]] std::optional<supervision::GoalEnd> end() { return client_.end(); }

 private:
  void draw_route();

  GoalOptions options_;
  service::Goal goal_;
  GoalClient client_;
  supervision::GoalProgress progress_;
  bool route_printed_ = false;
  bool drawn_ = false;
};

}  // namespace topogeo::cli
