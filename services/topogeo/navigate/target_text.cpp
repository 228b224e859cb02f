#include "navigate/target_text.hpp"

#include <charconv>
#include <cmath>
#include <system_error>

#include "topogeo/service/service_options.hpp"
#include "topogeo/support/format.hpp"

namespace topogeo::cli {

std::optional<Eigen::Vector2d> point_of(std::string_view text) {
  const std::size_t comma = text.find(',');
  if (comma == std::string_view::npos) return std::nullopt;
  const auto number = [](std::string_view part) -> std::optional<double> {
    double value = 0.0;
    const char* end = part.data() + part.size();
    const auto [rest, error] = std::from_chars(part.data(), end, value);
    if (error != std::errc() || rest != end || !std::isfinite(value)) return std::nullopt;
    return value;
  };
  const auto x = number(text.substr(0, comma));
  const auto y = number(text.substr(comma + 1));
  if (!x || !y) return std::nullopt;
  return Eigen::Vector2d(*x, *y);
}

Eigen::Vector2d point_for(std::string_view flag, std::string_view text) {
  const auto point_m = point_of(text);
  if (point_m) return *point_m;
  throw service::UsageError(fmt::format(
      "{} = '{}': expected X,Y in metres of the map frame, for example 1.5,-2", flag, text));
}

planning::Target target_of(const std::string& text) {
  if (const auto point = point_of(text)) return *point;
  if (text.starts_with('#')) {
    planning::NodeNumber node;
    const char* end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data() + 1, end, node.id);
    if (error == std::errc() && rest == end) return node;
  }
  return text;
}

std::string no_route_text(const planning::HybridRoute& route) {
  if (!route.nearest_reachable_m) return route.reason;
  return fmt::format("{}; ({:.2f}, {:.2f}) is the nearest place that can be reached", route.reason,
                     route.nearest_reachable_m->x(), route.nearest_reachable_m->y());
}

}  // namespace topogeo::cli
