#include "topogeo/simulation/simulate_log.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "topogeo/simulation/people.hpp"
#include "topogeo/support/seed.hpp"

namespace topogeo::simulation {
namespace {

void check_option(bool ok, const std::string& name, const std::string& expected) {
  if (!ok) throw std::invalid_argument(name + ": expected " + expected);
}

void check_option(const SimulationOptions& o) {
  check_option(o.scan_step_m >= 0.01 && o.scan_step_m <= 10.0, "scan_step_m", "[0.01, 10] m");
  check_option(o.scan_step_rad >= 0.01 && o.scan_step_rad <= std::numbers::pi, "scan_step_rad",
               "[0.01, pi] rad");
  check_option(o.start_stamp_ns >= 0, "start_stamp_ns", "a number >= 0");
  check_option(o.beams.count >= 2 && o.beams.count <= 2048, "beams.count", "[2, 2048]");
  check_option(o.beams.angle_step_rad > 0.0 && std::isfinite(o.beams.angle_step_rad),
               "beams.angle_step_rad", "a number > 0");
  check_option(o.beams.range_max_m > 0.0, "beams.range_max_m", "a number > 0");
  check_option(o.laser.sigma_m >= 0.0 && o.laser.bound_m >= 0.0 && o.laser.resolution_m >= 0.0,
               "laser", "sigma_m, bound_m and resolution_m >= 0");
  // Errors are redrawn until they lie within the bound, which must not take forever.
  check_option(o.laser.bound_m == 0.0 || o.laser.sigma_m <= 10.0 * o.laser.bound_m, "laser.sigma_m",
               "at most ten times bound_m");
  check_option(o.laser.dropout_probability >= 0.0 && o.laser.dropout_probability <= 1.0,
               "laser.dropout_probability", "[0, 1]");
  for (std::size_t i = 0; i < o.kidnappings.size(); ++i) {
    check_option(o.kidnappings[i].at_path_m >= (i > 0 ? o.kidnappings[i - 1].at_path_m : 0.0),
                 "kidnappings.at_path_m", "numbers >= 0 in ascending order");
    check_option(o.kidnappings[i].to_path_m >= 0.0, "kidnappings.to_path_m", "a number >= 0");
  }
  for (const Blinding& blinding : o.blindings) {
    check_option(blinding.path.from_m < blinding.path.to_m, "blindings.path", "from_m < to_m");
    check_option(
        !blinding.reading_m || (*blinding.reading_m > 0.0 && std::isfinite(*blinding.reading_m)),
        "blindings.reading_m", "a number > 0");
  }
}

// The drive with its kidnappings: poses one tick apart, some after a jump.
class Journey {
 public:
  Journey(const world::World& world, const SimulationOptions& options)
      : poses_(drive(world.tour_m, options.drive)), kidnappings_(options.kidnappings) {
    path_m_.push_back(0.0);
    for (std::size_t i = 1; i < poses_.size(); ++i) {
      const geometry::Pose2 step =
          geometry::between(poses_[i - 1].T_world_robot, poses_[i].T_world_robot);
      path_m_.push_back(path_m_.back() + step.position_m().norm());
    }
    for (const Kidnapping& kidnapping : kidnappings_) {
      check_option(kidnapping.to_path_m <= path_m_.back(), "kidnappings.to_path_m",
                   "at most the length of the tour, " + std::to_string(path_m_.back()) + " m");
    }
  }

  // Advances one tick; false at the end.
  bool next() {
    if (at_ + 1 >= poses_.size()) return false;
    const double step_m = path_m_[at_ + 1] - path_m_[at_];
    turned_rad_ =
        std::fabs(geometry::between(T_world_robot(), poses_[at_ + 1].T_world_robot).theta_rad);
    ++at_;
    ++ticks_;
    driven_m_ += step_m;
    step_m_ = step_m;
    carried_ = kidnapped_ < kidnappings_.size() && driven_m_ >= kidnappings_[kidnapped_].at_path_m;
    if (carried_) {
      T_world_left_ = T_world_robot();
      const double to_m = kidnappings_[kidnapped_++].to_path_m;
      const auto place = std::lower_bound(path_m_.begin(), path_m_.end(), to_m);
      at_ = std::min(static_cast<std::size_t>(place - path_m_.begin()), poses_.size() - 1);
    }
    return true;
  }

  [[nodiscard]] const geometry::Pose2& T_world_robot() const { return poses_[at_].T_world_robot; }
  // Last pose before a kidnapping.
  [[nodiscard]] const geometry::Pose2& T_world_left() const { return T_world_left_; }
  [[nodiscard]] bool at_end() const { return at_ + 1 >= poses_.size(); }
  [[nodiscard]] double driven_m() const { return driven_m_; }
  [[nodiscard]] double step_m() const { return step_m_; }
  [[nodiscard]] double turned_rad() const { return turned_rad_; }
  [[nodiscard]] bool carried() const { return carried_; }  // at the end of the last tick
  [[nodiscard]] double end_s() const { return static_cast<double>(poses_.back().time_ns) * 1e-9; }
  [[nodiscard]] std::int64_t time_ns() const { return ticks_ * poses_[1].time_ns; }

 private:
  std::vector<TimedPose> poses_;
  std::vector<double> path_m_;  // of each pose
  const std::vector<Kidnapping>& kidnappings_;
  std::size_t kidnapped_ = 0;
  std::size_t at_ = 0;
  std::int64_t ticks_ = 0;
  double driven_m_ = 0.0;
  double step_m_ = 0.0;
  double turned_rad_ = 0.0;
  bool carried_ = false;
  geometry::Pose2 T_world_left_;
};

std::vector<float> readings(const world::World& scene, const geometry::Pose2& T_world_robot,
                            double driven_m, const SimulationOptions& options,
                            support::Random& random) {
  std::vector<float> ranges_m = measure(
      raycast(scene, T_world_robot * options.T_robot_laser, options.beams), options.laser, random);
  for (const Blinding& blinding : options.blindings) {
    if (driven_m < blinding.path.from_m || driven_m >= blinding.path.to_m) continue;
    const float reading_m =
        blinding.reading_m ? static_cast<float>(*blinding.reading_m) : scan::Scan::kNoReturn;
    std::fill(ranges_m.begin(), ranges_m.end(), reading_m);
  }
  return ranges_m;
}

void add_people(const People& people, const Eigen::Vector2d& laser_m, world::World& scene) {
  constexpr double kNotSeen_m = 0.15;
  for (const world::Circle& person : people.circles()) {
    if ((person.center_m - laser_m).norm() < person.radius_m + kNotSeen_m) continue;
    scene.circles.push_back(person);
  }
}

}  // namespace

SimulatedLog simulate_log(const world::World& given_world, const SimulationOptions& options) {
  check_option(options);
  Journey journey(given_world, options);
  const world::World world = draw_changes(given_world, options.seed, journey.end_s());
  // Separate seeds: a change of the laser does not change the odometry, and vice versa.
  support::Random laser_random(support::derive_seed(options.seed, "laser", {}));
  OdometryModel odometry(options.odometry,
                         support::Random(support::derive_seed(options.seed, "odometry", {})));
  People people(world, options.wanderers, options.seed);
  SimulatedLog log;
  double travelled_m = 0.0;
  double turned_rad = 0.0;
  do {
    travelled_m += journey.step_m();
    turned_rad += journey.turned_rad();
    if (journey.carried()) {
      odometry.advance(journey.T_world_left());
      odometry.carry(journey.T_world_robot());
    }
    const bool first = log.scans.empty();
    const bool due = travelled_m >= options.scan_step_m || turned_rad >= options.scan_step_rad;
    if (!due && !first && !journey.at_end()) continue;
    travelled_m = 0.0;
    turned_rad = 0.0;
    const geometry::Pose2& T_world_robot = journey.T_world_robot();
    const double time_s = static_cast<double>(journey.time_ns()) * 1e-9;
    world::World scene = scene_at(world, journey.driven_m(), time_s);
    people.walk(time_s, scene, T_world_robot.position_m());
    add_people(people, (T_world_robot * options.T_robot_laser).position_m(), scene);
    scan::Scan scan;
    scan.sequence = log.scans.size();
    scan.stamp_ns = options.start_stamp_ns + journey.time_ns();
    scan.angle_min_rad = options.beams.angle_min_rad;
    scan.angle_step_rad = options.beams.angle_step_rad;
    scan.ranges_m = readings(scene, T_world_robot, journey.driven_m(), options, laser_random);
    scan.T_odom_robot = odometry.advance(T_world_robot);
    log.scans.push_back(std::move(scan));
    log.T_world_robot.push_back(T_world_robot);
  } while (journey.next());
  return log;
}

}  // namespace topogeo::simulation
