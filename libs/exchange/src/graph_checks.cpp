#include "graph_checks.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "topogeo/support/format.hpp"

#include "segments.hpp"

namespace topogeo::exchange {
namespace {

template <typename Element>
void sort_by_id(std::vector<Element>& elements, const std::string& name, const char* what) {
  std::ranges::stable_sort(elements, {}, &Element::id);
  const auto repeated = std::ranges::adjacent_find(elements, {}, &Element::id);
  if (repeated == elements.end()) return;
  throw std::runtime_error(
      fmt::format("{}: {} {}: expected each id once", name, what, repeated->id));
}

/// The value that the zone's kind expects instead of this one; empty for a good one.
std::string fault_of_value(const planning::DrawnZone& zone) {
  using planning::ZoneKind;
  const bool slow =
      zone.value >= planning::kLeastZoneSpeed_m_s && zone.value <= planning::kMostZoneSpeed_m_s;
  if (zone.kind == ZoneKind::kSlow && !slow) {
    return fmt::format("a speed of {:g} to {:g} m/s, got {:g}", planning::kLeastZoneSpeed_m_s,
                       planning::kMostZoneSpeed_m_s, zone.value);
  }
  if (zone.kind == ZoneKind::kOneWay && !(std::fabs(zone.value) <= std::numbers::pi)) {
    return fmt::format("a direction of -pi to pi rad, got {:g}", zone.value);
  }
  return {};
}

}  // namespace

std::string settle_border(std::vector<Eigen::Vector2d>& corners) {
  if (corners.size() > 1 && corners.front() == corners.back()) corners.pop_back();
  if (corners.size() < 3) return "three corners or more";
  return is_simple(corners) ? "" : "a border that neither crosses nor touches itself";
}

void settle_zones(std::span<planning::DrawnZone> zones, const std::string& name) {
  for (planning::DrawnZone& zone : zones) {
    std::string fault = settle_border(zone.polygon_m);
    if (fault.empty()) fault = fault_of_value(zone);
    if (fault.empty()) continue;
    throw std::runtime_error(fmt::format("{}: zone '{}': expected {}", name, zone.name, fault));
  }
}

void settle(MapGraph& graph, const std::string& name) {
  sort_by_id(graph.map.nodes, name, "node");
  sort_by_id(graph.map.branches, name, "branch");
  for (const topomap::MapBranch& branch : graph.map.branches) {
    for (const std::uint32_t id : {branch.node_a, branch.node_b}) {
      if (std::ranges::binary_search(graph.map.nodes, id, {}, &topomap::MapNode::id)) continue;
      throw std::runtime_error(
          fmt::format("{}: branch {} ends at node {}, which does not exist", name, branch.id, id));
    }
  }
  try {
    storage::check(graph.drawing);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(name + ": " + error.what());
  }
}

}  // namespace topogeo::exchange
