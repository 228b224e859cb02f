// Drawings on a live map.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "topogeo/messaging/message.hpp"
#include "topogeo/msg/hybrid_map.h"
#include "topogeo/service/drawing_conversions.hpp"
#include "topogeo/support/format.hpp"

#include "convert.hpp"

namespace topogeo::service {

// storage::check limits the number of zones and lines.
static_assert(msg::kMaxDrawnZones >= storage::kMaxDrawnZones);
static_assert(msg::kMaxDrawnLines >= storage::kMaxDrawnLines);

using detail::check_bound;
using detail::to_point;

namespace {

// Limits of zone files.
constexpr double kSlowestMps = 0.01;
constexpr double kFastestMps = 10.0;

std::vector<msg::Point2> to_points(const std::vector<Eigen::Vector2d>& points_m) {
  check_bound("points of a zone or line", points_m.size(), msg::kMaxDrawnPoints);
  std::vector<msg::Point2> out;
  out.reserve(points_m.size());
  for (const Eigen::Vector2d& point_m : points_m) out.push_back(to_point(point_m));
  return out;
}

std::vector<Eigen::Vector2d> from_points(const std::vector<msg::Point2>& points) {
  std::vector<Eigen::Vector2d> out;
  out.reserve(points.size());
  for (const msg::Point2& point : points) out.emplace_back(point.x_m(), point.y_m());
  return out;
}

void require(bool condition, const char* list, std::size_t index, const std::string& what) {
  if (!condition) throw storage::DrawingError(list, index, what);
}

void check_live_zone(const planning::DrawnZone& zone, std::size_t index) {
  require(zone.polygon_m.size() <= msg::kMaxDrawnPoints, "zones", index,
          fmt::format("zone '{}': {} corners, expected at most {}", zone.name,
                      zone.polygon_m.size(), msg::kMaxDrawnPoints));
  if (zone.kind == planning::ZoneKind::kSlow) {
    require(zone.value >= kSlowestMps && zone.value <= kFastestMps, "zones", index,
            fmt::format("zone '{}': {} m/s, expected {} to {}", zone.name, zone.value, kSlowestMps,
                        kFastestMps));
  }
  if (zone.kind == planning::ZoneKind::kOneWay) {
    require(std::fabs(zone.value) <= std::numbers::pi, "zones", index,
            fmt::format("zone '{}': heading {}, expected -pi to pi", zone.name, zone.value));
  }
}

void check_live(const storage::MapDrawing& drawing) {
  for (std::size_t i = 0; i < drawing.zones.size(); ++i) check_live_zone(drawing.zones[i], i);
  std::array<std::size_t, planning::kLineKinds> counts{};
  for (const planning::DrawnLine& line : drawing.lines) {
    const std::size_t index = counts.at(static_cast<std::size_t>(line.kind))++;
    require(
        line.points_m.size() <= msg::kMaxDrawnPoints, storage::list_of(line.kind), index,
        fmt::format("{} points, expected at most {}", line.points_m.size(), msg::kMaxDrawnPoints));
  }
}

}  // namespace

msg::DrawingContent to_msg(const storage::MapDrawing& drawing) {
  msg::DrawingContent out;
  check_bound("places", drawing.places.size(), msg::kMaxPlaces);
  for (const planning::Place& place : drawing.places) {
    msg::DrawnPlace& entry = out.places().emplace_back();
    messaging::set_text(entry.name(), place.name, "place");
    entry.position(to_point(place.position_m));
    entry.is_station(place.station_heading_rad.has_value());
    entry.heading_rad(place.station_heading_rad.value_or(0.0));
  }
  check_bound("zones", drawing.zones.size(), msg::kMaxDrawnZones);
  for (const planning::DrawnZone& zone : drawing.zones) {
    msg::DrawnArea& entry = out.zones().emplace_back();
    messaging::set_text(entry.name(), zone.name, "zone");
    entry.kind(static_cast<std::uint8_t>(zone.kind));
    entry.value(zone.value);
    entry.corners(to_points(zone.polygon_m));
  }
  check_bound("walls, openings and doors", drawing.lines.size(), msg::kMaxDrawnLines);
  for (const planning::DrawnLine& line : drawing.lines) {
    msg::DrawnPath& entry = out.lines().emplace_back();
    messaging::set_text(entry.name(), line.name, "line");
    entry.kind(static_cast<std::uint8_t>(line.kind));
    entry.points(to_points(line.points_m));
  }
  return out;
}

storage::MapDrawing from_msg(const msg::DrawingContent& content) {
  storage::MapDrawing drawing;
  for (const msg::DrawnPlace& entry : content.places()) {
    planning::Place& place = drawing.places.emplace_back();
    place.name = entry.name().to_string();
    place.position_m = {entry.position().x_m(), entry.position().y_m()};
    if (entry.is_station()) place.station_heading_rad = entry.heading_rad();
  }
  for (const msg::DrawnArea& entry : content.zones()) {
    detail::check(entry.kind() < planning::kZoneKinds, "kind of a zone", "0 to 4");
    drawing.zones.push_back({entry.name().to_string(), from_points(entry.corners()),
                             static_cast<planning::ZoneKind>(entry.kind()), entry.value()});
  }
  for (const msg::DrawnPath& entry : content.lines()) {
    detail::check(entry.kind() < planning::kLineKinds, "kind of a line", "0 to 2");
    drawing.lines.push_back({static_cast<planning::LineKind>(entry.kind()),
                             from_points(entry.points()), entry.name().to_string()});
  }
  check_drawing(drawing);
  return drawing;
}

void check_drawing(const storage::MapDrawing& drawing) {
  try {
    storage::check(drawing);
    check_live(drawing);
  } catch (const storage::DrawingError& error) {
    throw std::invalid_argument(storage::located(error));
  } catch (const std::runtime_error& error) {
    throw std::invalid_argument(error.what());
  }
}

void drop_grid_lines(storage::MapDrawing& drawing) {
  std::erase_if(drawing.lines, [](const planning::DrawnLine& line) {
    return line.kind != planning::LineKind::kDoor;
  });
}

void check_rules(const storage::MapDrawing& drawing) {
  const auto zones = std::ranges::count_if(drawing.zones, [](const planning::DrawnZone& zone) {
    return zone.kind != planning::ZoneKind::kRoom;
  });
  const std::size_t rules = drawing.lines.size() + static_cast<std::size_t>(zones);
  if (rules <= msg::kMaxRules) return;
  throw std::invalid_argument(
      fmt::format("{} zones with a rule, walls, openings and doors over a map, expected at most {}",
                  rules, msg::kMaxRules));
}

}  // namespace topogeo::service
