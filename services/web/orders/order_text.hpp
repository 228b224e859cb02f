// Parses the operator's orders from the bodies of requests.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"

namespace topogeo::web {

/// A place or room by its name, or a point.
struct WantedGoal {
  std::string name;                        ///< empty if the goal is a point
  std::optional<Eigen::Vector2d> point_m;  ///< map frame
  std::optional<double> heading_rad;       ///< map frame
  double wait_s = 0.0;                     ///< time that the robot stays there before the next goal
};

struct GoalOrders {
  std::vector<WantedGoal> goals;  ///< 1 to 50, in sequence
  bool append = false;            ///< true: keep the waiting goals before these
  std::uint32_t rounds = 1;       ///< times that the list is driven; 0: until it is cancelled
};

struct PoseOrder {
  geometry::Pose2 T_map_robot;
  std::optional<double> sigma_m;
  std::optional<double> sigma_rad;
};

struct MergeOrder {
  std::uint32_t number = 0;
  bool accept = false;
};

// All parsers throw std::invalid_argument that names the key and the expected value.
GoalOrders parse_goals(const std::string& body);
PoseOrder parse_pose_order(const std::string& body);
MergeOrder parse_merge_order(const std::string& body);
/// Returns true for the mode "mapping", false for "localization".
bool parse_mapping_mode(const std::string& body);
/// Returns the name in {"name": "monday"}.
std::string parse_name(const std::string& body, const char* key = "name");
/// Returns whether a cancel keeps the goals for a resume: {"keep": true}.
bool parse_keep(const std::string& body);
struct ControlsOrder {
  enum class Kind : std::uint8_t { kAsk, kTake, kGive, kKeep, kLetGo, kRename };
  Kind kind = Kind::kAsk;
  std::string name;  ///< the new name, for kRename
};

/// Parses {"do": KIND}: "ask", "take", "give", "keep", "let_go", or "rename" with a "name".
ControlsOrder parse_controls_order(const std::string& body);
/// Returns the 1 to 200 numbers in {"acknowledge": [1, 2]}.
std::vector<std::uint64_t> parse_alarm_numbers(const std::string& body);
/// Checks that the body is empty or a JSON object, whose keys are ignored.
void check_plain(const std::string& body);

/// Text for people: the name of the goal, or its point as "1.20, 3.40" (m).
std::string describe(const WantedGoal& goal);

}  // namespace topogeo::web
