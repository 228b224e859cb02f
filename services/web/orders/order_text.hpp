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
  std::string name;                        ///< empty: a point
  std::optional<Eigen::Vector2d> point_m;  ///< map frame
  std::optional<double> heading_rad;       ///< map frame
  double wait_s = 0.0;                     ///< that the robot stays there before the next one
};

struct GoalOrders {
  std::vector<WantedGoal> goals;  ///< 1 to 50, in sequence
  bool append = false;            ///< after the waiting ones
  std::uint32_t rounds = 1;       ///< 0: until they are cancelled
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

// All functions throw std::invalid_argument naming key and expectation.
GoalOrders parse_goals(const std::string& body);
PoseOrder parse_pose_order(const std::string& body);
MergeOrder parse_merge_order(const std::string& body);
/// "mapping" (true) or "localization".
bool parse_mapping_mode(const std::string& body);
/// Returns the name in {"name": "monday"}.
std::string parse_name(const std::string& body, const char* key = "name");
/// Whether a cancel keeps the goals for a resume: {"keep": true}.
bool parse_keep(const std::string& body);
struct ControlsOrder {
  enum class Kind : std::uint8_t { kAsk, kTake, kGive, kKeep, kLetGo, kRename };
  Kind kind = Kind::kAsk;
  std::string name;  ///< kRename
};

/// {"do": "ask", "take", "give", "keep", "let_go" or "rename"}, the last one with "name".
ControlsOrder parse_controls_order(const std::string& body);
/// Returns the numbers in {"acknowledge": [1, 2]}, 1 to 200.
std::vector<std::uint64_t> parse_alarm_numbers(const std::string& body);
/// Accepts only a body without content: empty, or an object.
void check_plain(const std::string& body);

/// For people: "place room A" or "1.20, 3.40".
std::string describe(const WantedGoal& goal);

}  // namespace topogeo::web
