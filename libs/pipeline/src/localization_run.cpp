#include "topogeo/pipeline/localization_run.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "topogeo/storage/read_map.hpp"
#include "topogeo/storage/tum.hpp"
#include "topogeo/support/format.hpp"

#include "pose_text.hpp"

namespace topogeo::pipeline {

geometry::Pose2 parse_pose(const std::string& text) {
  const auto values = parse_three_numbers(text);
  if (!values) {
    throw std::invalid_argument("pose '" + text + "': expected x,y,degrees in metres and degrees");
  }
  const auto [x_m, y_m, degrees] = *values;
  constexpr double kMostDegrees = 36000.0;
  if (std::fabs(degrees) > kMostDegrees) {
    throw std::invalid_argument("pose '" + text + "': expected at most 36000 degrees");
  }
  return {x_m, y_m, geometry::wrap_angle(degrees * std::numbers::pi / 180.0)};
}

namespace {

/// A map file, reduced to the stops with poses.
storage::MapDocument load_usable_map(const std::filesystem::path& file) {
  storage::MapDocument document = storage::identified(storage::read_map(file));
  document.local_maps.resize(document.trajectory.stops.size());
  for (const topomap::StopPose& stop : document.trajectory.stops) {
    if (stop.located) continue;
    throw std::runtime_error(
        fmt::format("{}: stop {} has no pose: expected a map, got a drive localized in a map",
                    file.string(), stop.local_map_id));
  }
  for (const topomap::LocalMap& local_map : document.local_maps) {
    if (!local_map.points.empty()) return document;
  }
  throw std::runtime_error(
      file.string() +
      ": no stop of the map has scan points; `topogeo store import --with-stops` makes "
      "stops of a grid");
}

localization::EdgeKind kind_of(storage::MapEdge::Kind kind) {
  switch (kind) {
    case storage::MapEdge::Kind::kOdometry:
      return localization::EdgeKind::kOdometry;
    case storage::MapEdge::Kind::kLoop:
      return localization::EdgeKind::kRevisit;
    case storage::MapEdge::Kind::kSequential:
    case storage::MapEdge::Kind::kUnknown:
      break;
  }
  return localization::EdgeKind::kSequential;
}

storage::MapEdge::Kind kind_of(localization::EdgeKind kind) {
  switch (kind) {
    case localization::EdgeKind::kOdometry:
      return storage::MapEdge::Kind::kOdometry;
    case localization::EdgeKind::kRevisit:
      return storage::MapEdge::Kind::kLoop;
    case localization::EdgeKind::kSequential:
      break;
  }
  return storage::MapEdge::Kind::kSequential;
}

std::string mounting_text(const geometry::Pose2& T_robot_laser) {
  return fmt::format("{:.4f},{:.4f} m, {:.4f} rad", T_robot_laser.x_m, T_robot_laser.y_m,
                     T_robot_laser.theta_rad);
}

}  // namespace

std::shared_ptr<const localization::StoredMap> load_stored_map(const std::filesystem::path& file) {
  return stored_map(load_usable_map(file));
}

std::shared_ptr<const localization::StoredMap> stored_map(const storage::MapDocument& document) {
  localization::StoredMap stored{
      document.local_maps, document.trajectory, document.loop_closures, {}};
  stored.edges = pose_graph_edges(document.edges);
  std::erase_if(stored.edges, [&](const localization::PoseGraphEdge& edge) {
    return edge.to >= document.trajectory.stops.size();
  });
  return std::make_shared<const localization::StoredMap>(std::move(stored));
}

std::vector<localization::PoseGraphEdge> pose_graph_edges(std::span<const storage::MapEdge> edges) {
  std::vector<localization::PoseGraphEdge> out;
  out.reserve(edges.size());
  for (const storage::MapEdge& edge : edges) {
    out.push_back({edge.earlier_id, edge.later_id, kind_of(edge.kind), edge.T_earlier_later,
                   edge.covariance});
  }
  return out;
}

std::vector<storage::MapEdge> map_edges(std::span<const localization::PoseGraphEdge> edges) {
  std::vector<storage::MapEdge> out;
  out.reserve(edges.size());
  for (const localization::PoseGraphEdge& edge : edges) {
    out.push_back({edge.from, edge.to, edge.T_from_to, edge.covariance, kind_of(edge.kind)});
  }
  return out;
}

std::shared_ptr<const storage::MapDocument> load_map_to_continue(const std::filesystem::path& file,
                                                                 const Config& config,
                                                                 const std::string& robot_id) {
  auto document = std::make_shared<const storage::MapDocument>(load_usable_map(file));
  if (document->robot_id != robot_id) {
    throw std::runtime_error(fmt::format("{}: the map is of robot '{}', expected '{}' (--robot)",
                                         file.string(), document->robot_id, robot_id));
  }
  const geometry::Pose2& expected = config.local_mapper.T_robot_laser;
  for (const topomap::LocalMap& map : document->local_maps) {
    if (map.T_robot_laser == expected) continue;
    throw std::runtime_error(fmt::format(
        "{}: made with the laser at {}, expected {} as in the configuration (laser.x_m, laser.y_m, "
        "laser.yaw_rad) or the log",
        file.string(), mounting_text(map.T_robot_laser), mounting_text(expected)));
  }
  return document;
}

storage::ReasonCounts continuation_counts(const localization::MappingSession& session) {
  return {{"stored_stops", session.stored_stops()},
          {"added_stops", session.added_stops()},
          {"unmapped_stops", session.unmapped_stops()}};
}

std::string continuation_message(const localization::MappingSession& session) {
  const std::size_t waiting = session.waiting_stops();
  if (waiting == 0) return {};
  const bool grew = session.added_stops() > 0;
  return fmt::format("the robot was not localized in the map ({}): {} stops are not mapped{}",
                     localization::to_string(session.status().state), waiting,
                     grew ? "" : ", the map is unchanged");
}

std::string localization_csv_header() {
  return "stop,stamp_s,x_m,y_m,theta_rad,state,confidence,sigma_x_m,sigma_y_m,sigma_theta_rad,"
         "accepted_matches\n";
}

std::string localization_csv_rows(std::span<const localization::LocalizedStop> stops) {
  std::string text;
  for (const localization::LocalizedStop& s : stops) {
    const Eigen::Matrix3d& c = s.covariance;
    text += fmt::format(
        "{},{},{:.6f},{:.6f},{:.6f},{},{:.4f},{:.4f},{:.4f},{:.4f},{}\n", s.stop.number,
        storage::stamp_text(s.stamp_ns), s.T_map_robot.x_m, s.T_map_robot.y_m,
        s.T_map_robot.theta_rad, localization::to_string(s.status.state), s.status.confidence,
        std::sqrt(c(0, 0)), std::sqrt(c(1, 1)), std::sqrt(c(2, 2)), s.accepted_matches);
  }
  return text;
}

std::string localization_csv(std::span<const localization::LocalizedStop> stops) {
  return localization_csv_header() + localization_csv_rows(stops);
}

storage::ReasonCounts localization_counts(const localization::MapTracker& tracker) {
  const auto& stops = tracker.stops_by_state();
  storage::ReasonCounts counts;
  for (std::size_t i = 0; i < stops.size(); ++i) {
    counts.emplace_back(localization::to_string(static_cast<localization::LocalizationState>(i)),
                        stops.at(i));
  }
  counts.emplace_back("searches", tracker.searches());
  return counts;
}

}  // namespace topogeo::pipeline
