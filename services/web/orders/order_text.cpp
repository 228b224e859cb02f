#include "orders/order_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "topogeo/support/format.hpp"

#include "orders/json_reading.hpp"

namespace topogeo::web {
namespace {

constexpr std::size_t kMostGoals = 50;
constexpr std::size_t kMostAlarms = 200;
constexpr std::size_t kLongestName = 64;  // limit of the messages
constexpr double kFarthest_m = 1e5;
constexpr double kLongestWait_s = 86400.0;
constexpr double kMostRounds = 1000.0;

bool flag(const Json& json, const char* key, bool otherwise) {
  const auto found = json.find(key);
  if (found == json.end()) return otherwise;
  if (!found->is_boolean())
    throw std::invalid_argument(fmt::format("{}: expected true or false", key));
  return found->get<bool>();
}

WantedGoal goal_of(const Json& json) {
  if (!json.is_object()) throw std::invalid_argument("goals: expected objects");
  WantedGoal goal;
  if (const auto place = json.find("place"); place != json.end()) {
    if (!place->is_string() || place->get<std::string>().empty() ||
        place->get<std::string>().size() > kLongestName) {
      throw std::invalid_argument("place: expected a name of 1 to 64 bytes");
    }
    goal.name = place->get<std::string>();
  } else {
    goal.point_m = Eigen::Vector2d(needed(json, "x_m", -kFarthest_m, kFarthest_m),
                                   needed(json, "y_m", -kFarthest_m, kFarthest_m));
  }
  constexpr double kTurn_rad = 2.0 * std::numbers::pi;
  goal.heading_rad = number(json, "heading_rad", -kTurn_rad, kTurn_rad);
  goal.wait_s = number(json, "wait_s", 0.0, kLongestWait_s).value_or(0.0);
  return goal;
}

}  // namespace

GoalOrders parse_goals(const std::string& body) {
  const Json json = object_of(body);
  GoalOrders orders;
  orders.append = flag(json, "append", false);
  orders.rounds =
      static_cast<std::uint32_t>(number(json, "repeat", 0.0, kMostRounds).value_or(1.0));
  const auto list = json.find("goals");
  if (list == json.end()) {
    if (orders.rounds != 1) throw std::invalid_argument("repeat: expected a list of goals");
    orders.goals.push_back(goal_of(json));
    return orders;
  }
  if (!list->is_array() || list->empty() || list->size() > kMostGoals) {
    throw std::invalid_argument("goals: expected a list of 1 to 50");
  }
  for (const Json& goal : *list) orders.goals.push_back(goal_of(goal));
  if (orders.rounds != 1 && (orders.append || orders.goals.size() < 2)) {
    throw std::invalid_argument("repeat: expected two goals or more, without append");
  }
  return orders;
}

PoseOrder parse_pose_order(const std::string& body) {
  const Json json = object_of(body);
  constexpr double kTurn_rad = 2.0 * std::numbers::pi;
  PoseOrder order;
  order.T_map_robot.x_m = needed(json, "x_m", -kFarthest_m, kFarthest_m);
  order.T_map_robot.y_m = needed(json, "y_m", -kFarthest_m, kFarthest_m);
  order.T_map_robot.theta_rad =
      geometry::wrap_angle(needed(json, "theta_rad", -kTurn_rad, kTurn_rad));
  order.sigma_m = number(json, "sigma_m", 0.01, 100.0);
  order.sigma_rad = number(json, "sigma_rad", 0.001, std::numbers::pi);
  return order;
}

MergeOrder parse_merge_order(const std::string& body) {
  const Json json = object_of(body);
  const auto answer = json.find("accept");
  if (answer == json.end()) throw std::invalid_argument("accept: expected true or false");
  constexpr double kMost = 4294967295.0;
  return {static_cast<std::uint32_t>(needed(json, "number", 0.0, kMost)),
          flag(json, "accept", false)};
}

bool parse_mapping_mode(const std::string& body) {
  const Json json = object_of(body);
  const auto mode = json.find("mode");
  if (mode != json.end() && *mode == "mapping") return true;
  if (mode != json.end() && *mode == "localization") return false;
  throw std::invalid_argument("mode: expected mapping or localization");
}

std::string parse_name(const std::string& body, const char* key) {
  const Json json = object_of(body);
  const auto name = json.find(key);
  if (name == json.end() || !name->is_string()) {
    throw std::invalid_argument(std::string(key) + ": expected a text");
  }
  return name->get<std::string>();
}

bool parse_keep(const std::string& body) {
  return !body.empty() && flag(object_of(body), "keep", false);
}

ControlsOrder parse_controls_order(const std::string& body) {
  using Kind = ControlsOrder::Kind;
  static constexpr std::array<std::pair<std::string_view, Kind>, 6> kKinds = {
      {{"ask", Kind::kAsk},
       {"take", Kind::kTake},
       {"give", Kind::kGive},
       {"keep", Kind::kKeep},
       {"let_go", Kind::kLetGo},
       {"rename", Kind::kRename}}};
  const Json json = object_of(body);
  const auto wanted = json.find("do");
  for (const auto& [word, kind] : kKinds) {
    if (wanted == json.end() || *wanted != word) continue;
    return {kind, kind == Kind::kRename ? parse_name(body) : std::string()};
  }
  throw std::invalid_argument("do: expected ask, take, give, keep, let_go or rename");
}

std::vector<std::uint64_t> parse_alarm_numbers(const std::string& body) {
  const Json json = object_of(body);
  const auto list = json.find("acknowledge");
  if (list == json.end() || !list->is_array() || list->empty() || list->size() > kMostAlarms ||
      !std::ranges::all_of(*list, [](const Json& one) { return one.is_number_unsigned(); })) {
    throw std::invalid_argument("acknowledge: expected a list of 1 to 200 numbers");
  }
  return list->get<std::vector<std::uint64_t>>();
}

void check_plain(const std::string& body) {
  if (!body.empty()) static_cast<void>(object_of(body));
}

std::string describe(const WantedGoal& goal) {
  if (!goal.name.empty()) return goal.name;
  return fmt::format("{:.2f}, {:.2f}", goal.point_m->x(), goal.point_m->y());
}

}  // namespace topogeo::web
