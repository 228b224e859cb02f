#include "drive_window.hpp"

#include <cmath>
#include <utility>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/matching/match_gate.hpp"

#include "pose_fusion.hpp"

namespace topogeo::localization {

using geometry::Pose2;

namespace {

// The previous stop, and another to check it: more hardly ever change the step.
constexpr std::size_t kStepMatches = 2;
constexpr double kStepWidening = 3.0;  // of the deviations, if no match was found as predicted

}  // namespace

DriveWindow::DriveWindow(MatchRequests& requests) : requests_(requests) {}

DriveStep DriveWindow::add(std::shared_ptr<const topomap::LocalMap> map,
                           std::shared_ptr<const StopView> view,
                           const std::optional<UncertainPose>& odometry) {
  DriveStep step;
  step.T_before_now.covariance = invertible(step.T_before_now.covariance);
  if (!odometry) stops_.clear();
  if (stops_.empty()) {
    if (odometry) {  // from a stop outside this drive
      step.T_before_now = {odometry->T_a_b, invertible(odometry->covariance)};
      step.distance_m = std::sqrt(odometry->T_a_b.position_m().squaredNorm());
    }
    stops_.push_back({std::move(map), std::move(view), Pose2{}, 0.0});
    return step;
  }
  const UncertainPose expected{odometry->T_a_b,
                               invertible(monitor_.expected(odometry->covariance))};
  UncertainPose predicted{odometry->T_a_b, invertible(monitor_.widened(odometry->covariance))};
  if (heading_is_lost(predicted)) predicted = expected;
  std::optional<UncertainPose> matched;
  if (!heading_is_lost(predicted)) matched = match_near(*map, predicted, step);
  if (matched) {
    monitor_.add(*odometry, *matched);
    step.T_before_now = fused({expected, *matched});
    step.matched = true;
  } else {
    step.T_before_now = expected;
  }
  step.distance_m = std::sqrt(step.T_before_now.T_a_b.position_m().squaredNorm());
  const Stop before = stops_.back();
  // Odometry alone cannot exclude that the robot was carried away, so the earlier view is of no
  // use.
  if (!matched) stops_.clear();
  stops_.push_back({std::move(map), std::move(view),
                    before.T_window_robot * step.T_before_now.T_a_b,
                    before.path_m + step.distance_m});
  while (stops_.back().path_m - stops_.front().path_m > kKept_m) stops_.pop_front();
  return step;
}

// T_before_now by matches with the last stops. A widened search finds look-alikes, too.
std::optional<UncertainPose> DriveWindow::match_near(const topomap::LocalMap& map,
                                                     const UncertainPose& odometry,
                                                     DriveStep& step) {
  if (auto matched = match(map, odometry, 1.0, step)) return matched;
  std::optional<UncertainPose> matched = match(map, odometry, kStepWidening, step);
  if (matched && !agree(odometry, *matched, OdometryMonitor::kNear2)) {
    step.match.reset();
    return std::nullopt;
  }
  return matched;
}

// T_before_now by accepted matches with the last stops.
std::optional<UncertainPose> DriveWindow::match(const topomap::LocalMap& map,
                                                const UncertainPose& odometry, double widening,
                                                DriveStep& step) {
  std::vector<MatchTask> tasks;
  std::vector<Pose2> T_before_earlier;
  for (std::size_t i = stops_.size(); i-- > 0 && tasks.size() < kStepMatches;) {
    const Pose2 T_earlier_before =
        geometry::between(stops_[i].T_window_robot, stops_.back().T_window_robot);
    T_before_earlier.push_back(geometry::inverse(T_earlier_before));
    UncertainPose T_earlier_now = compose({T_earlier_before, Eigen::Matrix3d::Zero()}, odometry);
    T_earlier_now.covariance *= widening * widening;
    MatchTask task = requests_.make(map.id, stops_[i].map->id, inverse(T_earlier_now));
    task.initial_individuals.push_back(geometry::inverse(T_earlier_before * map.T_previous_robot));
    tasks.push_back(std::move(task));
  }
  const std::vector<MatchResult> results = requests_.run(tasks);
  std::vector<UncertainPose> measured;
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (i == 0) step.match.emplace(tasks[i], results[i]);
    if (results[i].verdict != Verdict::kAccepted) continue;
    const UncertainPose T_earlier_query{results[i].T_reference_query,
                                        honest_covariance(results[i], tasks[i].evidence)};
    measured.push_back(
        compose({T_before_earlier[i], Eigen::Matrix3d::Zero()}, inverse(T_earlier_query)));
  }
  if (measured.empty()) return std::nullopt;
  return fused(measured);
}

std::vector<SurfacePoint> DriveWindow::seen(double length_m) const {
  std::vector<SurfacePoint> points;
  for (std::size_t i = stops_.size(); i-- > 0;) {
    if (stops_.back().path_m - stops_[i].path_m > length_m) break;
    add_moved(stops_[i].view->near,
              geometry::between(stops_.back().T_window_robot, stops_[i].T_window_robot), points);
  }
  return points;
}

double DriveWindow::length_m() const {
  return stops_.empty() ? 0.0 : stops_.back().path_m - stops_.front().path_m;
}

}  // namespace topogeo::localization
