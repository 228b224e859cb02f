// Numbers and texts of messages in the JSON of the protocol.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace topogeo::web {

using Json = nlohmann::ordered_json;

/// On one line; invalid UTF-8 is replaced.
inline std::string text_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// Rounds to a thousandth: millimetres, milliradians. Infinite values and NaN become null.
inline Json rounded(double value) {
  constexpr double kThousandths = 1000.0;
  if (!std::isfinite(value)) return nullptr;
  const double number = std::round(value * kThousandths) / kThousandths;
  return number == 0.0 ? 0.0 : number;  // never -0
}

/// Full precision; infinite values and NaN become null.
inline Json exact(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

/// Seconds, to a millisecond.
inline Json seconds(std::int64_t stamp_ns) {
  return rounded(static_cast<double>(stamp_ns) / 1e9);
}

/// Converts a bounded text of a message.
template <class Text>
std::string text_of_message(const Text& text) {
  return text.c_str();
}

/// "name", or "name: reason" where there is one.
inline std::string with_reason(std::string_view name, const std::string& reason) {
  return std::string(name) + (reason.empty() ? "" : ": " + reason);
}

/// Sets x_m, y_m and theta_rad.
template <class Pose>
void set_pose(Json& json, const Pose& T_map_robot) {
  json["x_m"] = rounded(T_map_robot.x_m);
  json["y_m"] = rounded(T_map_robot.y_m);
  json["theta_rad"] = rounded(T_map_robot.theta_rad);
}

}  // namespace topogeo::web
