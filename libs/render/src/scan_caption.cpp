#include "scan_caption.hpp"

#include <algorithm>
#include <array>

#include "topogeo/support/format.hpp"
#include "topogeo/topomap/node_kind_name.hpp"

namespace topogeo::render {
namespace {

using topomap::NodeKind;

std::string plural(std::size_t count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

/// "9 nodes (3 real, 1 door, 5 fictitious)".
std::string node_counts(const topomap::LocalMap& map) {
  constexpr std::array kKinds{NodeKind::kReal,         NodeKind::kDoor,       NodeKind::kNarrowing,
                              NodeKind::kHallCorridor, NodeKind::kFictitious, NodeKind::kVirtual};
  std::string kinds;
  for (const NodeKind kind : kKinds) {
    const auto count = std::ranges::count(map.nodes, kind, &topomap::LocalNode::kind);
    if (count == 0) continue;
    kinds += fmt::format("{}{} {}", kinds.empty() ? "" : ", ", count, topomap::name_of(kind));
  }
  return plural(map.nodes.size(), "node", "nodes") + (kinds.empty() ? "" : " (" + kinds + ")");
}

}  // namespace

std::string scan_title(const ScanView& view, const std::string& log_name) {
  const std::int64_t stamp_ms = view.scan.stamp_ns / 1'000'000;
  return fmt::format("{}   scan {} (counted from 0)   stamp {}.{:03d} s{}", log_name,
                     view.scan.sequence, stamp_ms / 1000, stamp_ms % 1000,
                     view.diagram.is_virtual ? "   VIRTUAL" : "");
}

std::string scan_counts(const ScanView& view) {
  const auto off =
      std::ranges::count(view.map.branches, false, &topomap::LocalBranch::in_main_graph);
  return fmt::format("{} beams, {}{}, {}, {}{}; range limit {:g} m, cells {:g} m",
                     view.scan.ranges_m.size(),
                     plural(view.diagram.groups.groups.size(), "group", "groups"),
                     view.diagram.is_virtual ? " with the virtual ones" : "", node_counts(view.map),
                     plural(view.map.branches.size(), "branch", "branches"),
                     off > 0 ? fmt::format(" ({} off the main graph)", off) : "",
                     view.voronoi.range_limit_m, view.voronoi.resolution_m);
}

}  // namespace topogeo::render
