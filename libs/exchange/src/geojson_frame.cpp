#include "geojson_frame.hpp"

#include <cmath>
#include <string>

#include <Eigen/Geometry>
#include <GeographicLib/LocalCartesian.hpp>

#include "topogeo/support/format.hpp"

namespace topogeo::exchange {
namespace {

Eigen::Vector2d numbers_of(const JsonValue& value) {
  const std::vector<JsonValue> items = value.items();
  if (items.size() < 2) value.fail("[x, y]");
  return {items[0].any_number(), items[1].any_number()};
}

/// Adds the positions below a value: coordinates are lists of lists of numbers.
void add_positions(const JsonValue& value, Eigen::AlignedBox2d& box) {
  const std::vector<JsonValue> items = value.items();
  if (items.empty()) return;
  if (items.front().is_number()) {
    box.extend(numbers_of(value));
    return;
  }
  for (const JsonValue& item : items) add_positions(item, box);
}

/// Lines are left out: an edge follows from its nodes, and some programs write any line for it.
void add_geometry(const JsonValue& geometry, Eigen::AlignedBox2d& box) {
  if (!geometry.is_object()) return;
  const JsonValue type = geometry.at("type");
  if (type.is_text() && type.text().ends_with("LineString")) return;
  if (const JsonValue coordinates = geometry.at("coordinates"); coordinates.exists()) {
    add_positions(coordinates, box);
  }
  const JsonValue geometries = geometry.at("geometries");
  if (!geometries.exists()) return;
  for (const JsonValue& one : geometries.items()) add_geometry(one, box);
}

std::string name_of_system(const JsonValue& top) {
  const JsonValue system = top.at("crs");
  if (!system.is_object() || !system.at("properties").is_object()) return {};
  const JsonValue name = system.at("properties").at("name");
  return name.is_text() ? name.text() : std::string();
}

bool is_in_degrees(const std::string& system, const Eigen::AlignedBox2d& box) {
  if (system.ends_with("CRS84") || system.ends_with("4326")) return true;
  // No drawing of a building is as small in metres.
  constexpr double kSmallest_m = 0.05;
  const bool possible = box.max().x() <= 180.0 && box.min().x() >= -180.0 &&
                        box.max().y() <= 90.0 && box.min().y() >= -90.0;
  const double extent = box.sizes().maxCoeff();
  return system.empty() && possible && extent > 0.0 && extent < kSmallest_m;
}

}  // namespace

GeojsonFrame::GeojsonFrame(const JsonValue& top) {
  Eigen::AlignedBox2d box;
  for (const JsonValue& feature : top.required("features").items()) {
    add_geometry(feature.at("geometry"), box);
  }
  to_map_ = [](const Eigen::Vector2d& position_m) { return position_m; };
  if (box.isEmpty()) return;
  const Eigen::Vector2d middle = box.center();
  if (is_in_degrees(name_of_system(top), box)) {
    const GeographicLib::LocalCartesian plane(middle.y(), middle.x());
    to_map_ = [plane](const Eigen::Vector2d& degrees) {
      double east_m = 0.0;
      double north_m = 0.0;
      double up_m = 0.0;
      plane.Forward(degrees.y(), degrees.x(), 0.0, east_m, north_m, up_m);
      return Eigen::Vector2d(east_m, north_m);
    };
    notes_.push_back(
        fmt::format("degrees of WGS84, taken to metres east and north of latitude {:.7f}, "
                    "longitude {:.7f}",
                    middle.y(), middle.x()));
    return;
  }
  // Farther away the cells of a grid could not be numbered; no building reaches as far.
  constexpr double kFarthest_m = 1e5;
  if (box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).maxCoeff() <= kFarthest_m) return;
  const Eigen::Vector2d origin_m = middle.array().round();
  to_map_ = [origin_m](const Eigen::Vector2d& position_m) -> Eigen::Vector2d {
    return position_m - origin_m;
  };
  notes_.push_back(fmt::format("the origin of the map is at x = {:.0f}, y = {:.0f} m of the file",
                               origin_m.x(), origin_m.y()));
}

Eigen::Vector2d GeojsonFrame::position_m(const JsonValue& value) const {
  return to_map_(numbers_of(value));
}

}  // namespace topogeo::exchange
