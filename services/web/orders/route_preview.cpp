#include "orders/route_preview.hpp"

#include <algorithm>
#include <limits>
#include <optional>

#include "topogeo/navigation/drive_time.hpp"

#include "server/json_values.hpp"

namespace topogeo::web {

Answer preview_route(const planning::PlanningMaps& maps, const geometry::Pose2& T_map_robot,
                     const std::vector<Eigen::Vector2d>& goals_m,
                     const planning::GoalPlannerConfig& config,
                     const navigation::NavigatorConfig& navigator) {
  Answer answer;
  std::vector<Eigen::Vector2d> points_m;
  double length_m = 0.0;
  double clearance_m = std::numeric_limits<double>::infinity();
  Eigen::Vector2d start_m = T_map_robot.position_m();
  double time_s = 0.0;
  std::optional<double> heading_rad = T_map_robot.theta_rad;
  const planning::FreeSpace* space = maps.hybrid == nullptr ? nullptr : &maps.hybrid->space();
  for (std::size_t k = 0; k < goals_m.size(); ++k) {
    const Eigen::Vector2d& goal_m = goals_m[k];
    const planning::HybridRoute route = planning::plan_to_goal(maps, start_m, goal_m, {}, config);
    if (!route.found()) {
      Json json = {{"found", false}, {"message", route.reason}, {"goal", k}};
      if (const auto& nearest_m = route.nearest_reachable_m) {
        json["nearest_reachable"] = {{"x_m", rounded(nearest_m->x())},
                                     {"y_m", rounded(nearest_m->y())}};
      }
      answer.body = text_of(json);
      return answer;
    }
    length_m += route.length_m;
    clearance_m = std::min(clearance_m, route.min_clearance_m);
    points_m.insert(points_m.end(), route.points_m.begin(), route.points_m.end());
    time_s += navigation::drive_time_s(route.points_m, heading_rad, space, navigator);
    heading_rad.reset();  // at a goal the robot may look in any direction
    start_m = goal_m;
  }
  Json points = Json::array();
  for (const Eigen::Vector2d& point_m : points_m) {
    points.push_back(rounded(point_m.x()));
    points.push_back(rounded(point_m.y()));
  }
  answer.body = text_of(Json{{"found", true},
                             {"length_m", rounded(length_m)},
                             {"time_s", rounded(time_s)},
                             {"min_clearance_m", rounded(clearance_m)},
                             {"points_m", std::move(points)}});
  return answer;
}

}  // namespace topogeo::web
