#include "topogeo/exchange/repair.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include "topogeo/pipeline/mapping_run.hpp"
#include "topogeo/support/format.hpp"

#include "element_reader.hpp"
#include "map_fields.hpp"
#include "repaired_rooms.hpp"
#include "wire.hpp"

namespace topogeo::exchange {
namespace {

using F = MapFields;

std::string with_id(std::string message, std::uint32_t field, std::uint64_t id) {
  return std::move(message) + varint_field(field, id);
}

/// Local maps without content, which other elements can refer to.
std::string empty_stops(const std::string& robot_id, std::uint32_t count) {
  std::string fields;
  for (std::uint32_t id = 0; id < count; ++id) {
    fields += bytes_field(
        F::kLocalMap, with_id(bytes_field(F::kRobotOfLocalMap, robot_id), F::kIdOfLocalMap, id));
  }
  return fields;
}

// Limits that only a damaged exponent exceeds. The global map has the same
// (global_map_builder.hpp).
constexpr double kFarthestPoint_m = 500.0;
constexpr double kFarthestPose_m = 5000.0;

void require_within(const Eigen::Vector2d& position_m, double most_m) {
  if (!(position_m.cwiseAbs().maxCoeff() <= most_m)) throw std::runtime_error("far away");
}

/// Throws std::runtime_error for coordinates beyond the range of any laser.
void check_plausible(const topomap::LocalMap& map) {
  for (const topomap::ScanPoint& p : map.points) require_within({p.x_m, p.y_m}, kFarthestPoint_m);
  for (const topomap::LocalNode& node : map.nodes) {
    require_within(node.position_m, kFarthestPoint_m);
  }
  for (const topomap::LocalBranch& branch : map.branches) {
    for (const topomap::BranchPoint& p : branch.points) {
      require_within(p.position_m, kFarthestPoint_m);
    }
  }
  require_within(map.T_previous_robot.position_m(), kFarthestPose_m);
}

class Assembler {
 public:
  Assembler(const StoredPieces& pieces, const topomap::GlobalMapConfig& config)
      : pieces_(pieces), config_(config), robot_(robot_of(pieces)) {
    out_.lost = pieces.damage;
    out_.document.robot_id = robot_;
    out_.document.seed = pieces.seed;
    out_.document.map_id = pieces.map_id;
  }

  RepairedMap assemble(const std::string& name) {
    take_stops();
    take_poses();
    take_pairs();
    take_refused_merges();
    take_drawing();
    take_graph();
    out_.document.rooms = repaired_rooms(pieces_, robot_, out_.lost);
    if (out_.document.local_maps.empty() && out_.document.drawing.empty() &&
        out_.document.global_map.nodes.empty()) {
      throw std::runtime_error(name + ": nothing can be recovered");
    }
    return std::move(out_);
  }

 private:
  static std::string robot_of(const StoredPieces& pieces) {
    if (!pieces.robot_id.empty()) return pieces.robot_id;
    // If the file's own field is damaged, each local map begins with the same one.
    for (const StoredPieces::StoredStop& stop : pieces.stops) {
      std::size_t at = 0;
      const auto field = read_field(stop.local_map, at);
      if (field && field->number == F::kRobotOfLocalMap && !field->payload.empty()) {
        return std::string(field->payload);
      }
    }
    return "robot";
  }

  template <typename... Args>
  void lose(fmt::format_string<Args...> format, Args&&... args) {
    out_.lost.push_back(fmt::format(format, std::forward<Args>(args)...));
  }

  template <typename Take>
  void take_each(const std::vector<std::string>& elements, const char* what, const Take& take) {
    exchange::take_each(elements, what, out_.lost, take);
  }

  void take_stops() {
    std::map<std::uint32_t, topomap::LocalMap> found;
    std::size_t unreadable = 0;
    for (const StoredPieces::StoredStop& stop : pieces_.stops) {
      try {
        storage::MapDocument alone = read_alone(
            robot_, bytes_field(F::kLocalMap,
                                with_id(stop.local_map + bytes_field(F::kRobotOfLocalMap, robot_),
                                        F::kIdOfLocalMap, 0)));
        topomap::LocalMap map = std::move(alone.local_maps.at(0));
        check_plausible(map);
        map.id = stop.id;
        if (stop.starts_drive) map.starts_drive = *stop.starts_drive;
        found[stop.id] = std::move(map);
      } catch (const std::exception&) {
        ++unreadable;
      }
    }
    if (unreadable > 0) lose("{} local maps cannot be read", unreadable);
    if (found.empty()) return;
    const std::uint32_t count = found.rbegin()->first + 1;
    for (std::uint32_t id = 0; id < count; ++id) {
      const auto at = found.find(id);
      if (at != found.end()) {
        out_.document.local_maps.push_back(std::move(at->second));
      } else {
        out_.document.local_maps.push_back(empty_stop(id));
        missing_.push_back(id);
      }
    }
    name_stops();
    if (!missing_.empty()) {
      lose("{} stops have no local map, the first is stop {}", missing_.size(), missing_.front());
    }
  }

  /// A missing stop becomes the next one of the session before it, or the previous one of the
  /// session behind it. If such a number is already used, or some stops have no session, all names
  /// are dropped.
  void name_stops() {
    std::vector<topomap::LocalMap>& maps = out_.document.local_maps;
    for (const std::uint32_t id : missing_) {
      if (id > 0 && maps[id - 1].stop.session != 0) {
        maps[id].stop = {maps[id - 1].stop.session, maps[id - 1].stop.number + 1};
      }
    }
    for (std::size_t i = missing_.size(); i-- > 0;) {
      const std::uint32_t id = missing_[i];
      if (maps[id].stop.session != 0 || id + 1 >= maps.size()) continue;
      const topomap::StopId& next = maps[id + 1].stop;
      if (next.number > 0) maps[id].stop = {next.session, next.number - 1};
    }
    std::set<std::pair<std::uint64_t, std::uint32_t>> names;
    bool named = true;
    for (const topomap::LocalMap& map : maps) {
      named = named && map.stop.session != 0 &&
              names.insert({map.stop.session, map.stop.number}).second;
    }
    if (named) return;
    const auto has_name = [](const topomap::LocalMap& map) { return map.stop.session != 0; };
    if (std::ranges::any_of(maps, has_name)) lose("the sessions of the stops are lost");
    for (topomap::LocalMap& map : maps) map.stop = {};
  }

  [[nodiscard]] topomap::LocalMap empty_stop(std::uint32_t id) const {
    topomap::LocalMap map;
    map.robot_id = robot_;
    map.id = id;
    if (id > 0) map.stamp_ns = out_.document.local_maps[id - 1].stamp_ns + 1;
    return map;
  }

  void take_poses() {
    storage::MapDocument& document = out_.document;
    std::map<std::uint32_t, topomap::StopPose> found;
    take_each(pieces_.poses, "poses", [&](const std::string& element) {
      const auto id = number_in(element, F::kIdOfPose);
      if (!id || *id >= document.local_maps.size()) throw std::runtime_error("id");
      const auto alone = read_alone(
          robot_, empty_stops(robot_, 1) +
                      bytes_field(F::kTrajectory, bytes_field(F::kStopsOfTrajectory,
                                                              with_id(element, F::kIdOfPose, 0))));
      topomap::StopPose stop = alone.trajectory.stops.at(0);
      stop.local_map_id = static_cast<std::uint32_t>(*id);
      require_within(stop.T_map_robot.position_m(), kFarthestPose_m);
      found[stop.local_map_id] = stop;
    });
    std::size_t followed = 0;
    std::size_t unknown = 0;
    for (const topomap::LocalMap& map : document.local_maps) {
      const auto at = found.find(map.id);
      topomap::StopPose stop = at != found.end() ? at->second : pose_after(map, followed, unknown);
      stop.stop = map.stop;
      document.trajectory.stops.push_back(stop);
    }
    for (const std::uint32_t id : missing_) {
      // Its stamp comes from its pose, if there is one.
      if (found.contains(id)) document.local_maps[id].stamp_ns = found[id].stamp_ns;
      document.trajectory.stops[id].stamp_ns = document.local_maps[id].stamp_ns;
      if (id == 0) continue;
      const auto& stops = document.trajectory.stops;
      document.local_maps[id].T_previous_robot =
          geometry::between(stops[id - 1].T_map_robot, stops[id].T_map_robot);
    }
    if (followed > 0) lose("{} stops have poses by scan tracking alone", followed);
    if (unknown > 0) lose("{} stops have no pose", unknown);
    document.trajectory.version = std::max<std::uint64_t>(
        {pieces_.trajectory_version, pieces_.map_version, document.local_maps.empty() ? 0U : 1U});
  }

  /// The pose of a stop without one, derived from the previous stop.
  topomap::StopPose pose_after(const topomap::LocalMap& map, std::size_t& followed,
                               std::size_t& unknown) const {
    topomap::StopPose stop;
    stop.local_map_id = map.id;
    stop.stamp_ns = map.stamp_ns;
    const auto& before = out_.document.trajectory.stops;
    const bool is_missing = std::ranges::binary_search(missing_, map.id);
    if (map.id == 0 && !is_missing) return stop;  // the origin of the map
    stop.located = map.id > 0 && !map.starts_drive && !is_missing && before.back().located;
    ++(stop.located ? followed : unknown);
    if (!stop.located) return stop;
    stop.T_map_robot = before.back().T_map_robot * map.T_previous_robot;
    // A twentieth of the distance and three degrees per step, the worst case of tracking.
    const double step_m = map.T_previous_robot.position_m().norm();
    stop.covariance = before.back().covariance;
    stop.covariance.diagonal() +=
        Eigen::Vector3d(0.0025 * step_m * step_m, 0.0025 * step_m * step_m, 0.0027);
    return stop;
  }

  void take_pairs() {
    storage::MapDocument& document = out_.document;
    // Reads a pair with the ids 0 and 1, then restores its own ids.
    const auto alone = [&](const std::string& element, std::uint32_t field, auto use) {
      const auto first = number_in(element, F::kFirstOfPair);
      const auto second = number_in(element, F::kSecondOfPair);
      if (!first || !second || *first >= *second || *second >= document.local_maps.size()) {
        throw std::runtime_error("ids");
      }
      const std::string corrected =
          with_id(with_id(element, F::kFirstOfPair, 0), F::kSecondOfPair, 1);
      use(read_alone(robot_, empty_stops(robot_, 2) + bytes_field(field, corrected)),
          static_cast<std::uint32_t>(*first), static_cast<std::uint32_t>(*second));
    };
    take_each(pieces_.loops, "loops", [&](const std::string& element) {
      alone(element, F::kLoop, [&](const storage::MapDocument& read, auto first, auto second) {
        topomap::LoopClosure loop = read.loop_closures.at(0);
        loop.earlier_id = first;
        loop.later_id = second;
        document.loop_closures.push_back(loop);
      });
    });
    take_each(pieces_.edges, "measurements", [&](const std::string& element) {
      alone(element, F::kEdge, [&](const storage::MapDocument& read, auto first, auto second) {
        storage::MapEdge edge = read.edges.at(0);
        edge.earlier_id = first;
        edge.later_id = second;
        document.edges.push_back(edge);
      });
    });
  }

  void take_refused_merges() {
    take_each(pieces_.refused_merges, "refused merges", [&](const std::string& element) {
      out_.document.refused_merges.push_back(
          read_alone(robot_, bytes_field(F::kRefusedMerge, element)).refused_merges.at(0));
    });
  }

  void take_drawing() {
    storage::MapDrawing& drawing = out_.document.drawing;
    const auto alone = [&](std::uint32_t field, const std::string& element) {
      return read_alone(robot_, bytes_field(F::kDrawing, bytes_field(field, element))).drawing;
    };
    take_each(pieces_.places, "places", [&](const std::string& element) {
      drawing.places.push_back(alone(F::kPlaces, element).places.at(0));
      drop_if_bad(drawing, drawing.places);
    });
    take_each(pieces_.zones, "zones", [&](const std::string& element) {
      drawing.zones.push_back(alone(F::kZones, element).zones.at(0));
      drop_if_bad(drawing, drawing.zones);
    });
    take_each(pieces_.lines, "walls, openings and doors", [&](const std::string& element) {
      drawing.lines.push_back(alone(F::kLines, element).lines.at(0));
      drop_if_bad(drawing, drawing.lines);
    });
    if (pieces_.grid.empty()) return;
    take_each({pieces_.grid}, "grids",
              [&](const std::string& element) { drawing.grid = alone(F::kGrid, element).grid; });
  }

  /// Drops an invalid entry, for instance one with a used name.
  template <typename Entry>
  static void drop_if_bad(const storage::MapDrawing& drawing, std::vector<Entry>& entries) {
    try {
      storage::check(drawing);
    } catch (const std::exception&) {
      entries.pop_back();
      throw;
    }
  }

  void take_graph() {
    topomap::GlobalMap& map = out_.document.global_map;
    map.version = pieces_.map_version;
    const std::size_t before = out_.lost.size();
    const auto alone = [&](const std::string& parts) {
      return read_alone(robot_, bytes_field(F::kGlobalMap, parts)).global_map;
    };
    take_each(pieces_.nodes, "nodes", [&](const std::string& element) {
      map.nodes.push_back(alone(bytes_field(F::kNodes, element)).nodes.at(0));
    });
    std::ranges::stable_sort(map.nodes, {}, &topomap::MapNode::id);
    const std::string node_zero = bytes_field(F::kNodes, "");
    take_each(pieces_.branches, "branches", [&](const std::string& element) {
      const auto a = number_in(element, F::kNodeA);
      const auto b = number_in(element, F::kNodeB);
      const std::string corrected = with_id(with_id(element, F::kNodeA, 0), F::kNodeB, 0);
      topomap::MapBranch branch =
          alone(node_zero + bytes_field(F::kBranches, corrected)).branches.at(0);
      branch.node_a = static_cast<std::uint32_t>(a.value());
      branch.node_b = static_cast<std::uint32_t>(b.value());
      for (const std::uint32_t id : {branch.node_a, branch.node_b}) {
        if (!std::ranges::binary_search(map.nodes, id, {}, &topomap::MapNode::id)) {
          throw std::runtime_error("end");
        }
      }
      map.branches.push_back(std::move(branch));
    });
    std::ranges::stable_sort(map.branches, {}, &topomap::MapBranch::id);
    remove_repeated(map.nodes);
    remove_repeated(map.branches);
    const bool damaged = out_.lost.size() > before || pieces_.graph_incomplete;
    if (!damaged && !map.nodes.empty()) return;
    if (pieces_.map_version == 0 && !damaged) return;  // the map had no graph
    make_graph();
  }

  template <typename Element>
  static void remove_repeated(std::vector<Element>& elements) {
    const auto same = [](const Element& a, const Element& b) { return a.id == b.id; };
    elements.erase(std::unique(elements.begin(), elements.end(), same), elements.end());
  }

  /// Makes the graph from the stops, if any is located.
  void make_graph() {
    const storage::MapDocument& document = out_.document;
    const auto located = [](const topomap::StopPose& stop) { return stop.located; };
    if (!std::ranges::any_of(document.trajectory.stops, located)) return;
    try {
      out_.document.global_map = pipeline::fuse(config_, document.local_maps, document.trajectory);
      lose("nodes and branches are rebuilt with new ids");
    } catch (const std::invalid_argument& error) {
      lose("nodes and branches cannot be rebuilt: {}", error.what());
    }
  }

  const StoredPieces& pieces_;
  const topomap::GlobalMapConfig& config_;
  std::string robot_;
  std::vector<std::uint32_t> missing_;  // ids of stops without content, ascending
  RepairedMap out_;
};

}  // namespace

RepairedMap assemble(const StoredPieces& pieces, const topomap::GlobalMapConfig& config,
                     const std::string& name) {
  return Assembler(pieces, config).assemble(name);
}

}  // namespace topogeo::exchange
