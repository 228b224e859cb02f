#include "topogeo/exchange/zone_rules.hpp"

#include <algorithm>

#include "topogeo/geometry/portable_math.hpp"

#include "segments.hpp"

namespace topogeo::exchange {
namespace {

DrivingRule rule_of(const planning::DrawnZone& zone, const Eigen::Vector2d& way_m) {
  constexpr double kCosOf120Degrees = -0.5;
  DrivingRule rule;
  if (zone.kind == planning::ZoneKind::kNoGo) rule.forward = rule.backward = false;
  if (zone.kind == planning::ZoneKind::kSlow) rule.speed_mps = zone.value;
  if (zone.kind == planning::ZoneKind::kOneWay) {
    const auto [sin, cos] = geometry::sincos(zone.value);
    const double along_m = way_m.dot(Eigen::Vector2d(cos, sin));
    const double limit_m = kCosOf120Degrees * way_m.norm();
    rule.forward = along_m >= limit_m;
    rule.backward = -along_m >= limit_m;
  }
  return rule;
}

}  // namespace

void DrivingRule::add(const DrivingRule& other) {
  forward = forward && other.forward;
  backward = backward && other.backward;
  if (other.speed_mps) speed_mps = std::min(speed_mps.value_or(*other.speed_mps), *other.speed_mps);
}

DrivingRule rule_between(std::span<const planning::DrawnZone> zones, const Eigen::Vector2d& from_m,
                         const Eigen::Vector2d& to_m) {
  DrivingRule rule;
  for (const planning::DrawnZone& zone : zones) {
    if (zone.kind == planning::ZoneKind::kRoom) continue;
    if (segment_touches(zone.polygon_m, from_m, to_m)) rule.add(rule_of(zone, to_m - from_m));
  }
  return rule;
}

}  // namespace topogeo::exchange
