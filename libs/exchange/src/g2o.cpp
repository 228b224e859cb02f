#include "topogeo/exchange/g2o.hpp"

#include <Eigen/LU>

#include "topogeo/slam/stored_map.hpp"
#include "topogeo/support/format.hpp"

#include "text.hpp"

namespace topogeo::exchange {
namespace {

std::string pose_text(const geometry::Pose2& pose) {
  return number_text(pose.x_m) + ' ' + number_text(pose.y_m) + ' ' + number_text(pose.theta_rad);
}

std::string edge_line(std::uint32_t from, std::uint32_t to, const geometry::Pose2& T_from_to,
                      const Eigen::Matrix3d& covariance) {
  const Eigen::Matrix3d information = covariance.inverse();
  std::string line = fmt::format("EDGE_SE2 {} {} {}", from, to, pose_text(T_from_to));
  for (int row = 0; row < 3; ++row) {
    for (int column = row; column < 3; ++column) {
      line += ' ' + number_text(information(row, column));
    }
  }
  return line + '\n';
}

/// Edges for a map that does not keep its measurements, from its stops and loops.
std::vector<storage::MapEdge> usual_edges(const storage::MapDocument& document) {
  const Eigen::Matrix3d usual = localization::usual_match_covariance();
  std::vector<storage::MapEdge> edges;
  for (std::uint32_t id = 1; id < document.trajectory.stops.size(); ++id) {
    const topomap::LocalMap& map = document.local_maps[id];
    if (!map.starts_drive) edges.push_back({id - 1, id, map.T_previous_robot, usual});
  }
  for (const topomap::LoopClosure& loop : document.loop_closures) {
    edges.push_back({loop.earlier_id, loop.later_id, loop.T_earlier_later, usual});
  }
  return edges;
}

}  // namespace

std::string g2o_text(const storage::MapDocument& document) {
  std::string text = "# topogeo: metres and radians; vertices are stops of the robot\n";
  const auto& stops = document.trajectory.stops;
  const auto located = [&](std::uint32_t id) { return id < stops.size() && stops[id].located; };
  bool fixed = false;
  for (const topomap::StopPose& stop : stops) {
    if (!stop.located) continue;
    text += fmt::format("VERTEX_SE2 {} {}\n", stop.local_map_id, pose_text(stop.T_map_robot));
    if (!fixed) text += fmt::format("FIX {}\n", stop.local_map_id);
    fixed = true;
  }
  if (document.edges.empty()) {
    text += "# the map keeps no covariances: every edge has that of a usual match\n";
  }
  for (const storage::MapEdge& edge :
       document.edges.empty() ? usual_edges(document) : document.edges) {
    if (!located(edge.earlier_id) || !located(edge.later_id)) continue;
    text += edge_line(edge.earlier_id, edge.later_id, edge.T_earlier_later, edge.covariance);
  }
  return text;
}

}  // namespace topogeo::exchange
