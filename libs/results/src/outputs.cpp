#include "topogeo/results/outputs.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "topogeo/matching/match_gate.hpp"
#include "topogeo/pipeline/odometry_links.hpp"
#include "topogeo/render/map_picture.hpp"
#include "topogeo/storage/map_file.hpp"
#include "topogeo/storage/tum.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::results {

namespace {

/// The stops that have a pose.
struct LocatedStops {
  std::vector<topomap::LocalMap> maps;
  std::vector<topomap::StopPose> stops;
};

storage::OverlapSolution solution_of(const localization::MatchSolution& solution,
                                     const pipeline::FitnessParts& parts) {
  return {solution.T_reference_query, solution.fitness, parts.scan, parts.topological, parts.prior};
}

LocatedStops located_stops(const storage::MapDocument& document) {
  LocatedStops out;
  for (std::size_t i = 0; i < document.trajectory.stops.size(); ++i) {
    if (!document.trajectory.stops[i].located) continue;
    out.maps.push_back(document.local_maps[i]);
    out.stops.push_back(document.trajectory.stops[i]);
  }
  return out;
}

/// Positions of the stops along each part of the path that rests on odometry alone.
std::vector<std::vector<Eigen::Vector2d>> unmatched_parts_m(const storage::MapDocument& document) {
  std::vector<std::vector<Eigen::Vector2d>> parts;
  const std::vector<topomap::StopPose>& stops = document.trajectory.stops;
  for (const pipeline::OdometryStretch& stretch : pipeline::odometry_stretches(document)) {
    std::vector<Eigen::Vector2d>& part = parts.emplace_back();
    for (std::size_t id = stretch.first_id; id <= stretch.last_id && id < stops.size(); ++id) {
      if (stops[id].located) part.push_back(stops[id].T_map_robot.position_m());
    }
  }
  return parts;
}

/// Middles of the occupied cells of the drawn grid that have a free neighbour, map frame.
std::vector<Eigen::Vector2d> walls_m(const storage::MapDrawing& drawing) {
  std::vector<Eigen::Vector2d> walls;
  if (!drawing.grid) return walls;
  const planning::OccupancyGrid& grid = *drawing.grid;
  const planning::GridFrame& frame = grid.frame();
  const auto is_free = [&](const planning::Cell& cell) {
    return frame.contains(cell) && grid.at(cell) == planning::CellState::kFree;
  };
  for (std::size_t i = 0; i < frame.size(); ++i) {
    if (grid.cells()[i] != planning::CellState::kOccupied) continue;
    const auto [column, row] = frame.cell_at(i);
    if (is_free({column + 1, row}) || is_free({column - 1, row}) || is_free({column, row + 1}) ||
        is_free({column, row - 1})) {
      walls.push_back(frame.center_m({column, row}));
    }
  }
  return walls;
}

/// Stamps of the first scans of drives, and of scans before which the odometry restarted.
std::vector<std::int64_t> drive_starts_ns(std::span<const topomap::LocalMap> maps) {
  std::vector<std::int64_t> starts;
  for (std::size_t i = 1; i < maps.size(); ++i) {
    if (topomap::has_odometry_between(maps[i - 1], maps[i])) continue;
    starts.push_back(maps[i].track.empty() ? maps[i].stamp_ns : maps[i].track.front().stamp_ns);
  }
  std::ranges::sort(starts);
  return starts;
}

std::vector<render::PictureZone> zones_of(const storage::MapDrawing& drawing) {
  std::vector<render::PictureZone> zones;
  for (const planning::DrawnZone& zone : drawing.zones) {
    zones.push_back({zone.kind, zone.polygon_m, zone.value});
  }
  return zones;
}

/// The point of a room nearest to the mean of those that a stop of the map or the floor itself
/// fixes; nothing without one.
std::optional<Eigen::Vector2d> middle_of(const planning::RememberedRoom& room,
                                         const planning::StopPoses& T_map_stops) {
  std::vector<Eigen::Vector2d> points_m;
  Eigen::Vector2d sum_m = Eigen::Vector2d::Zero();
  for (const planning::RoomPoint& point : room.points) {
    const auto at_m = planning::position_of(point, T_map_stops);
    if (!at_m) continue;
    points_m.push_back(*at_m);
    sum_m += *at_m;
  }
  if (points_m.empty()) return std::nullopt;
  const Eigen::Vector2d mean_m = sum_m / static_cast<double>(points_m.size());
  return *std::ranges::min_element(
      points_m, {}, [&](const Eigen::Vector2d& at_m) { return (at_m - mean_m).squaredNorm(); });
}

/// The names of places, drawn zones and numbered rooms.
std::vector<render::PictureName> names_of(const storage::MapDocument& document) {
  std::vector<render::PictureName> names;
  for (const planning::Place& place : document.drawing.places) {
    names.push_back({place.name, place.position_m, true});
  }
  for (const planning::DrawnZone& zone : document.drawing.zones) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (const Eigen::Vector2d& corner_m : zone.polygon_m) sum += corner_m;
    if (zone.polygon_m.empty()) continue;
    names.push_back({zone.name, sum / static_cast<double>(zone.polygon_m.size()), false});
  }
  const planning::StopPoses T_map_stops = planning::poses_of(document.trajectory.stops);
  for (const planning::RememberedRoom& room : document.rooms.rooms) {
    const std::string name = room.name.empty() ? planning::room_name(room.number) : room.name;
    if (const auto at_m = middle_of(room, T_map_stops)) names.push_back({name, *at_m, false});
  }
  return names;
}

/// Contents of a picture of the map.
struct Drawn {
  explicit Drawn(const storage::MapDocument& map)
      : document(map),
        located(located_stops(map)),
        odometry(topomap::expand_odometry(map.trajectory, map.local_maps)),
        corrected(topomap::expand_trajectory(map.trajectory, map.local_maps)) {}

  [[nodiscard]] render::MapPicture picture(const std::string& title,
                                           const PictureParts& parts = {}) const {
    render::MapPicture picture = whole_picture(title);
    if (!parts.odometry) picture.odometry = {};
    if (!parts.loops) picture.loop_closures = {};
    return picture;
  }

  [[nodiscard]] render::MapPicture whole_picture(const std::string& title) const {
    return {.local_maps = located.maps,
            .stops = located.stops,
            .odometry = odometry,
            .corrected = corrected,
            .loop_closures = document.loop_closures,
            .global_map = &document.global_map,
            .title = title,
            .unmatched_m = unmatched_parts_m(document),
            .walls_m = walls_m(document.drawing),
            .drive_starts_ns = drive_starts_ns(document.local_maps),
            .zones = zones_of(document.drawing),
            .names = names_of(document)};
  }

  const storage::MapDocument& document;
  LocatedStops located;
  std::vector<topomap::StampedPose> odometry;
  std::vector<topomap::StampedPose> corrected;
};

}  // namespace

void write_map_outputs(const std::filesystem::path& directory, const storage::MapDocument& document,
                       const std::string& title) {
  const Drawn drawn(document);
  storage::write_trajectory_tum(directory / "trajectory.tum", drawn.corrected);
  storage::write_trajectory_tum(directory / "odometry.tum", drawn.odometry);
  storage::write_map_file(directory / "map.pb", document);
  const render::MapPicture picture = drawn.picture(title);
  render::draw_map_svg(directory / "map.svg", picture);
  render::draw_map_png(directory / "map.png", picture);
}

std::string map_svg(const storage::MapDocument& document, const std::string& title,
                    const PictureParts& parts) {
  return render::map_svg(Drawn(document).picture(title, parts));
}

std::string map_png(const storage::MapDocument& document, const std::string& title,
                    const PictureParts& parts) {
  return render::map_png(Drawn(document).picture(title, parts));
}

void add_map(storage::Report& report, const storage::MapDocument& document) {
  report.robot_id = document.robot_id;
  report.seed = document.seed;
  report.stops = document.local_maps.size();
  report.nodes = document.global_map.nodes.size();
  report.branches = document.global_map.branches.size();
  report.loop_closures = document.loop_closures;
  const auto poses = topomap::expand_trajectory(document.trajectory, document.local_maps);
  report.scans = poses.size();
  report.distance_m = 0.0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    report.distance_m +=
        std::sqrt((poses[i].pose.position_m() - poses[i - 1].pose.position_m()).squaredNorm());
  }
}

void add_matches(storage::Report& report, const localization::SlamCounts& counts) {
  report.matches_tried = counts.tasks;
  report.matches_accepted = counts.reasons[static_cast<std::size_t>(localization::Reason::kNone)];
  report.matches_rejected.clear();
  for (std::size_t i = 1; i < localization::kReasons; ++i) {
    report.matches_rejected.emplace_back(
        localization::to_string(static_cast<localization::Reason>(i)), counts.reasons[i]);
  }
}

void add_loop_candidates(storage::Report& report,
                         std::span<const localization::LoopDecision> decisions) {
  report.loop_candidates.clear();
  report.loop_candidates.reserve(decisions.size());
  for (const localization::LoopDecision& d : decisions) {
    const Eigen::Matrix3d& covariance = d.predicted.covariance;
    report.loop_candidates.push_back(
        {d.step, d.earlier_id, d.later_id, localization::to_string(d.outcome),
         localization::to_string(d.reason), d.T_earlier_later, d.correction_m, d.correction_rad,
         d.fitness, localization::to_string(d.source), d.predicted.T_a_b,
         std::sqrt(covariance(0, 0) + covariance(1, 1)), std::sqrt(covariance(2, 2)),
         d.probability});
  }
}

void add_overlaps(storage::Report& report, std::span<const pipeline::StopOverlaps> overlaps) {
  report.overlaps.clear();
  report.overlaps.reserve(overlaps.size());
  for (const pipeline::StopOverlaps& of_stop : overlaps) {
    storage::Overlaps& out = report.overlaps.emplace_back();
    out.stop_id = of_stop.stop;
    out.overlap_set = of_stop.overlap_set;
    for (const auto& [earlier, search] : of_stop.searches) {
      const localization::MatchResult& result = search.result;
      storage::OverlapSearch& found = out.searches.emplace_back();
      found.earlier_id = earlier;
      found.T_predicted = search.task.T_reference_query;
      for (std::size_t i = 0; i < result.solutions.size(); ++i) {
        found.solutions.push_back(solution_of(result.solutions[i], search.solutions[i]));
      }
      if (result.status == localization::MatchStatus::kSolved) {
        found.refined = solution_of({result.T_reference_query, result.fitness}, search.refined);
      }
      found.verdict = localization::to_string(result.verdict);
      found.reason = localization::to_string(result.reason);
    }
  }
}

void add_log(storage::Report& report, const scan::CarmenLogStatistics& statistics) {
  report.skipped_lines.clear();
  for (std::size_t i = 0; i < scan::kSkipReasonCount; ++i) {
    const auto reason = static_cast<scan::SkipReason>(i);
    if (statistics.skipped_for(reason) > 0) {
      report.skipped_lines.emplace_back(scan::describe(reason), statistics.skipped_for(reason));
    }
  }
}

}  // namespace topogeo::results
