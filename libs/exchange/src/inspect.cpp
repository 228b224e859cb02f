#include "topogeo/exchange/inspect.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <nlohmann/json.hpp>

#include "topogeo/support/format.hpp"
#include "topogeo/topomap/node_kind_name.hpp"
#include "topogeo/topomap/trajectory.hpp"

#include "text.hpp"

namespace topogeo::exchange {
namespace {

using topomap::MapBranch;
using topomap::MapNode;

/// The smallest box around points.
class Extent {
 public:
  explicit Extent(MapSummary& summary) : summary_(summary) {}
  void add(const Eigen::Vector2d& point_m) {
    if (!summary_.has_extent) {
      summary_.low_m = summary_.high_m = point_m;
      summary_.has_extent = true;
    }
    summary_.low_m = summary_.low_m.cwiseMin(point_m);
    summary_.high_m = summary_.high_m.cwiseMax(point_m);
  }

 private:
  MapSummary& summary_;
};

double length_of(const MapBranch& branch) {
  double length_m = 0.0;
  for (std::size_t i = 1; i < branch.points.size(); ++i) {
    length_m +=
        std::sqrt((branch.points[i].position_m - branch.points[i - 1].position_m).squaredNorm());
  }
  return length_m;
}

/// Distance along the poses of all scans, drive by drive, without the jumps between drives.
double driven_distance(const storage::MapDocument& document) {
  const std::span<const topomap::LocalMap> maps(document.local_maps);
  const std::vector<topomap::StopPose>& stops = document.trajectory.stops;
  double driven_m = 0.0;
  for (std::size_t begin = 0; begin < stops.size();) {
    std::size_t end = begin + 1;
    while (end < stops.size() && !maps[end].starts_drive) ++end;
    const auto at = [&](std::size_t i) { return stops.begin() + static_cast<std::ptrdiff_t>(i); };
    const auto poses =
        topomap::expand_trajectory({0, {at(begin), at(end)}}, maps.subspan(begin, end - begin));
    for (std::size_t i = 1; i < poses.size(); ++i) {
      driven_m +=
          std::sqrt((poses[i].pose.position_m() - poses[i - 1].pose.position_m()).squaredNorm());
    }
    begin = end;
  }
  return driven_m;
}

void add_stops(MapSummary& summary, const storage::MapDocument& document) {
  Extent extent(summary);
  summary.stops = document.local_maps.size();
  std::set<std::uint64_t> sessions;
  for (const topomap::LocalMap& map : document.local_maps) {
    // Older files do not name the session: each drive is one.
    if (map.stop.session != 0) {
      sessions.insert(map.stop.session);
    } else if (map.id == 0 || map.starts_drive) {
      ++summary.sessions;
    }
    summary.points += map.points.size();
    if (map.id == 0) summary.first_stamp_ns = summary.last_stamp_ns = map.stamp_ns;
    summary.first_stamp_ns = std::min(summary.first_stamp_ns, map.stamp_ns);
    summary.last_stamp_ns = std::max(summary.last_stamp_ns, map.stamp_ns);
  }
  summary.sessions += sessions.size();
  for (const topomap::StopPose& stop : document.trajectory.stops) {
    summary.views += stop.views;
    summary.last_stamp_ns = std::max(summary.last_stamp_ns, stop.last_seen_ns());
    if (!stop.located) continue;
    ++summary.located_stops;
    extent.add(stop.T_map_robot.position_m());
    for (const topomap::ScanPoint& p : document.local_maps[stop.local_map_id].points) {
      extent.add(stop.T_map_robot * Eigen::Vector2d(p.x_m, p.y_m));
    }
  }
  summary.scans = topomap::expand_trajectory(document.trajectory, document.local_maps).size();
  summary.driven_m = driven_distance(document);
}

void add_drawing(MapSummary& summary, const storage::MapDrawing& drawing) {
  Extent extent(summary);
  summary.places = drawing.places.size();
  summary.zones = drawing.zones.size();
  for (const planning::Place& place : drawing.places) extent.add(place.position_m);
  for (const planning::DrawnZone& zone : drawing.zones) {
    for (const Eigen::Vector2d& corner : zone.polygon_m) extent.add(corner);
  }
  if (!drawing.grid) return;
  const planning::GridFrame& frame = drawing.grid->frame();
  summary.drawn_grid = frame;
  for (const double x : {0.0, frame.columns * frame.resolution_m}) {
    for (const double y : {0.0, frame.rows * frame.resolution_m}) {
      extent.add(frame.T_map_grid * Eigen::Vector2d(x, y));
    }
  }
}

/// Collects lines up to a limit.
class Findings {
 public:
  explicit Findings(std::size_t most) : most_(most) {}
  template <typename... Args>
  void add(fmt::format_string<Args...> format, Args&&... args) {
    if (lines_.size() < most_) lines_.push_back(fmt::format(format, std::forward<Args>(args)...));
  }
  std::vector<std::string> take() { return std::move(lines_); }

 private:
  std::size_t most_;
  std::vector<std::string> lines_;
};

// 1,000 km, as in drawings: a larger number is damaged.
constexpr double kFarthest_m = 1e6;

bool is_near(const Eigen::Vector2d& position_m) {
  return std::fabs(position_m.x()) <= kFarthest_m && std::fabs(position_m.y()) <= kFarthest_m;
}

/// Symmetric, and not negative in any direction by more than rounding.
bool is_covariance(const Eigen::Matrix3d& m) {
  const double scale = m.cwiseAbs().maxCoeff();
  if (!(scale < 1e12)) return false;
  const double tolerance = 1e-6 * scale;
  if ((m - m.transpose()).cwiseAbs().maxCoeff() > tolerance) return false;
  for (int i = 0; i < 3; ++i) {
    if (m(i, i) < -tolerance) return false;
    for (int j = 0; j < i; ++j) {
      if (m(i, j) * m(i, j) > m(i, i) * m(j, j) + tolerance * scale) return false;
    }
  }
  return true;
}

void check_stops(const storage::MapDocument& document, Findings& findings) {
  for (std::size_t i = 1; i < document.local_maps.size(); ++i) {
    const topomap::LocalMap& map = document.local_maps[i];
    const std::int64_t before_ns = document.local_maps[i - 1].stamp_ns;
    if (map.starts_drive || map.stamp_ns > before_ns) continue;
    findings.add("stop {}: stamp {} ns after {} ns, expected a later one in the same drive", i,
                 map.stamp_ns, before_ns);
  }
  for (const topomap::StopPose& stop : document.trajectory.stops) {
    const std::uint32_t id = stop.local_map_id;
    if (stop.stamp_ns != document.local_maps[id].stamp_ns) {
      findings.add("stop {}: stamp {} ns, its local map has {} ns", id, stop.stamp_ns,
                   document.local_maps[id].stamp_ns);
    }
    if (!stop.located) continue;
    if (!is_near(stop.T_map_robot.position_m())) {
      findings.add("stop {}: at ({:g}, {:g}) m, expected at most 1,000 km", id,
                   stop.T_map_robot.x_m, stop.T_map_robot.y_m);
    }
    if (!is_covariance(stop.covariance))
      findings.add("stop {}: its covariance is not positive semidefinite", id);
  }
  const auto located = [&](std::uint32_t id) {
    return id < document.trajectory.stops.size() && document.trajectory.stops[id].located;
  };
  for (const topomap::LoopClosure& loop : document.loop_closures) {
    for (const std::uint32_t id : {loop.earlier_id, loop.later_id}) {
      if (!located(id)) {
        findings.add("loop closure {}-{}: stop {} has no pose", loop.earlier_id, loop.later_id, id);
      }
    }
  }
}

void check_map(const topomap::GlobalMap& map, Findings& findings) {
  // Ends are copies of node positions; a millimetre allows for maps that other programs wrote.
  constexpr double kApart_m = 1e-3;
  for (const MapNode& node : map.nodes) {
    if (!is_near(node.position_m)) {
      findings.add("node {}: at ({:g}, {:g}) m, expected at most 1,000 km", node.id,
                   node.position_m.x(), node.position_m.y());
    }
    if (node.clearance_m < 0.0) {
      findings.add("node {}: clearance {:g} m, expected 0 or more", node.id, node.clearance_m);
    }
  }
  for (const MapBranch& branch : map.branches) {
    const std::array<std::pair<std::uint32_t, const topomap::BranchPoint*>, 2> ends = {
        {{branch.node_a, &branch.points.front()}, {branch.node_b, &branch.points.back()}}};
    for (const auto& [id, point] : ends) {
      const auto node = std::ranges::lower_bound(map.nodes, id, {}, &MapNode::id);
      const double apart_m = std::sqrt((node->position_m - point->position_m).squaredNorm());
      if (apart_m > kApart_m) {
        findings.add("branch {}: ends {:.3f} m from its node {}", branch.id, apart_m, id);
      }
    }
  }
}

}  // namespace

std::size_t MapSummary::node_count() const {
  std::size_t count = 0;
  for (const std::size_t of_kind : nodes) count += of_kind;
  return count;
}

MapSummary summarize(const storage::MapDocument& document) {
  MapSummary summary;
  summary.robot_id = document.robot_id;
  summary.seed = document.seed;
  add_stops(summary, document);
  Extent extent(summary);
  for (const MapNode& node : document.global_map.nodes) {
    ++summary.nodes[static_cast<std::size_t>(node.kind)];
    extent.add(node.position_m);
  }
  for (const MapBranch& branch : document.global_map.branches) {
    ++summary.branches;
    if (branch.is_virtual) {
      ++summary.virtual_branches;
    } else {
      summary.branches_m += length_of(branch);
    }
  }
  summary.loops = document.loop_closures.size();
  summary.trajectory_version = document.trajectory.version;
  summary.map_version = document.global_map.version;
  add_drawing(summary, document.drawing);
  return summary;
}

std::string summary_text(const MapSummary& s, std::uint64_t file_bytes) {
  std::string text =
      fmt::format("robot      {}, seed {}\n", s.robot_id.empty() ? "-" : s.robot_id, s.seed);
  text += fmt::format("stops      {} in {} {}, {} with a pose, for {} views, {} scan points\n",
                      s.stops, s.sessions, s.sessions == 1 ? "session" : "sessions",
                      s.located_stops, s.views, s.points);
  text += fmt::format("driven     {:.1f} m, {} scans", s.driven_m, s.scans);
  // The time between the drives of a merged map says nothing about them.
  text += s.sessions > 1
              ? std::string("\n")
              : fmt::format(", {:.1f} s from the first stop to the last\n",
                            static_cast<double>(s.last_stamp_ns - s.first_stamp_ns) * 1e-9);
  if (s.has_extent) {
    text += fmt::format("extent     {:.1f} x {:.1f} m, x {:.2f} to {:.2f}, y {:.2f} to {:.2f}\n",
                        s.high_m.x() - s.low_m.x(), s.high_m.y() - s.low_m.y(), s.low_m.x(),
                        s.high_m.x(), s.low_m.y(), s.high_m.y());
  }
  text += fmt::format("nodes      {}", s.node_count());
  const char* separator = ": ";
  for (std::size_t i = 0; i < s.nodes.size(); ++i) {
    if (s.nodes[i] == 0) continue;
    text +=
        fmt::format("{}{} {}", separator, s.nodes[i], name_of(static_cast<topomap::NodeKind>(i)));
    separator = ", ";
  }
  text += fmt::format("\nbranches   {}, {} of them virtual, {:.1f} m\nloops      {}\n", s.branches,
                      s.virtual_branches, s.branches_m, s.loops);
  text += fmt::format("drawing    {} places, {} zones", s.places, s.zones);
  if (s.drawn_grid) {
    text += fmt::format(", a grid of {} x {} cells of {:g} m", s.drawn_grid->columns,
                        s.drawn_grid->rows, s.drawn_grid->resolution_m);
  }
  return text + fmt::format("\nversions   trajectory {}, map {}\nsize       {} bytes\n",
                            s.trajectory_version, s.map_version, file_bytes);
}

std::string summary_json(const MapSummary& s, std::uint64_t file_bytes) {
  nlohmann::ordered_json kinds = nlohmann::ordered_json::object();
  for (std::size_t i = 0; i < s.nodes.size(); ++i) {
    kinds[std::string(name_of(static_cast<topomap::NodeKind>(i)))] = s.nodes[i];
  }
  nlohmann::ordered_json json = {{"robot_id", s.robot_id},
                                 {"seed", s.seed},
                                 {"sessions", s.sessions},
                                 {"stops", s.stops},
                                 {"located_stops", s.located_stops},
                                 {"views", s.views},
                                 {"scans", s.scans},
                                 {"points", s.points},
                                 {"first_stamp_ns", s.first_stamp_ns},
                                 {"last_stamp_ns", s.last_stamp_ns},
                                 {"driven_m", s.driven_m},
                                 {"extent_m", nullptr},
                                 {"nodes", s.node_count()},
                                 {"nodes_of_kind", std::move(kinds)},
                                 {"branches", s.branches},
                                 {"virtual_branches", s.virtual_branches},
                                 {"branches_m", s.branches_m},
                                 {"loops", s.loops},
                                 {"places", s.places},
                                 {"zones", s.zones},
                                 {"drawn_grid", nullptr},
                                 {"trajectory_version", s.trajectory_version},
                                 {"map_version", s.map_version},
                                 {"file_bytes", file_bytes}};
  if (s.has_extent) json["extent_m"] = {s.low_m.x(), s.low_m.y(), s.high_m.x(), s.high_m.y()};
  if (s.drawn_grid) {
    json["drawn_grid"] = {{"columns", s.drawn_grid->columns},
                          {"rows", s.drawn_grid->rows},
                          {"resolution_m", s.drawn_grid->resolution_m}};
  }
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + '\n';
}

std::vector<std::string> contradictions(const storage::MapDocument& document, std::size_t most) {
  Findings findings(most);
  check_stops(document, findings);
  check_map(document.global_map, findings);
  if (document.global_map.version > document.trajectory.version) {
    findings.add("map version {}: expected at most that of the trajectory, {}",
                 document.global_map.version, document.trajectory.version);
  }
  return findings.take();
}

}  // namespace topogeo::exchange
