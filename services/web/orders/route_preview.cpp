#include "orders/route_preview.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "topogeo/geometry/pose2.hpp"

#include "server/json_values.hpp"

namespace topogeo::web {
namespace {

double heading_rad(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m) {
  return std::atan2(to_m.y() - from_m.y(), to_m.x() - from_m.x());
}

}  // namespace

// The follower rounds corners that are not sharp, so only the turning takes time there.
double drive_time_s(const std::vector<Eigen::Vector2d>& points_m,
                    const navigation::FollowerConfig& follower) {
  double time_s =
      points_m.size() > 1 ? follower.speed_m_per_s / follower.acceleration_m_per_s2 : 0.0;
  for (std::size_t i = 1; i < points_m.size(); ++i) {
    time_s += (points_m[i] - points_m[i - 1]).norm() / follower.speed_m_per_s;
    if (i + 1 == points_m.size()) break;
    const double turn_rad = std::fabs(geometry::wrap_angle(
        heading_rad(points_m[i], points_m[i + 1]) - heading_rad(points_m[i - 1], points_m[i])));
    time_s += turn_rad / follower.turn_rad_per_s;
  }
  return time_s;
}

Answer preview_route(const planning::PlanningMaps& maps, const Eigen::Vector2d& from_m,
                     const std::vector<Eigen::Vector2d>& goals_m,
                     const planning::GoalPlannerConfig& config,
                     const navigation::FollowerConfig& follower) {
  Answer answer;
  std::vector<Eigen::Vector2d> points_m;
  double length_m = 0.0;
  double clearance_m = std::numeric_limits<double>::infinity();
  Eigen::Vector2d start_m = from_m;
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
    start_m = goal_m;
  }
  Json points = Json::array();
  for (const Eigen::Vector2d& point_m : points_m) {
    points.push_back(rounded(point_m.x()));
    points.push_back(rounded(point_m.y()));
  }
  answer.body = text_of(Json{{"found", true},
                             {"length_m", rounded(length_m)},
                             {"time_s", rounded(drive_time_s(points_m, follower))},
                             {"min_clearance_m", rounded(clearance_m)},
                             {"points_m", std::move(points)}});
  return answer;
}

}  // namespace topogeo::web
