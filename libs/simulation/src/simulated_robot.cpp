#include "topogeo/simulation/simulated_robot.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/simulation/contact.hpp"
#include "topogeo/support/seed.hpp"

namespace topogeo::simulation {
namespace {

// A step is driven in straight pieces: at 1 m/s and 1 rad/s less than 0.1 mm off the arc.
constexpr double kPiece_s = 0.02;

void check_robot(bool ok, const char* name, const char* expected) {
  if (!ok) throw std::invalid_argument(std::string(name) + ": expected " + expected);
}

RobotOptions checked(const world::World& world, RobotOptions o) {
  check_robot(o.radius_m > 0.0 && o.radius_m <= 5.0, "radius_m", "(0, 5] m");
  const std::string fault = geometry::fault_of(o.footprint);
  if (!fault.empty()) throw std::invalid_argument("footprint " + fault);
  check_robot(o.minimum_turning_radius_m >= 0.0 && o.minimum_turning_radius_m <= 10.0,
              "minimum_turning_radius_m", "[0, 10] m");
  check_robot(o.acceleration_m_per_s2 > 0.0, "acceleration_m_per_s2", "a number > 0");
  check_robot(o.angular_acceleration_rad_per_s2 > 0.0, "angular_acceleration_rad_per_s2",
              "a number > 0");
  check_robot(o.slip.per_m >= 0.0 && o.slip.per_m <= 10.0, "slip.per_m", "[0, 10]");
  check_robot(o.slip.length_m > 0.0 && o.slip.length_m <= 10.0, "slip.length_m", "(0, 10] m");
  check_robot(o.slip.lost_share >= 0.0 && o.slip.lost_share <= 1.0, "slip.lost_share", "[0, 1]");
  check_robot(o.beams.count >= 2 && o.beams.count <= 2048, "beams.count", "[2, 2048]");
  check_robot(o.beams.angle_step_rad > 0.0 && o.beams.range_max_m > 0.0, "beams",
              "angle_step_rad and range_max_m > 0");
  for (const devices::SonarMount& sonar : o.sonars) {
    check_robot(sonar.half_cone_rad > 0.0 && sonar.half_cone_rad < std::numbers::pi / 2.0,
                "sonars.half_cone_rad", "(0, pi/2)");
  }
  check_robot(o.sonar.sigma_m >= 0.0 && o.sonar.resolution_m >= 0.0 && o.sonar.range_min_m >= 0.0 &&
                  o.sonar.range_max_m > o.sonar.range_min_m,
              "sonar", "sigma_m, resolution_m and range_min_m >= 0, range_max_m > range_min_m");
  if (!o.T_world_start) o.T_world_start = TourFollower(world.tour_m, {}).start();
  return o;
}

// The base controls its encoder counts, so these follow the command and the robot's motion has the
// errors: from the same random numbers, with the opposite sign for systematic ones.
OdometryDrift of_robot(OdometryDrift drift) {
  drift.range_scale_error = 1.0 / (1.0 + drift.range_scale_error) - 1.0;
  drift.turn_scale_error = 1.0 / (1.0 + drift.turn_scale_error) - 1.0;
  drift.heading_drift_rad_per_m = -drift.heading_drift_rad_per_m;
  return drift;
}

support::Random random_for(const RobotOptions& options, const char* what) {
  return support::Random(support::derive_seed(options.seed, what, {}));
}

double towards(double now, double wanted, double largest_change) {
  return now + std::clamp(wanted - now, -largest_change, largest_change);
}

// Half the turn, the distance, the other half.
geometry::Pose2 arc(double forward_m, double turn_rad) {
  const geometry::SinCos half = geometry::sincos(turn_rad / 2.0);
  return {forward_m * half.cos, forward_m * half.sin, geometry::wrap_angle(turn_rad)};
}

}  // namespace

SimulatedRobot::SimulatedRobot(world::World world, const RobotOptions& options)
    : options_(checked(world, options)),
      world_(std::move(world)),
      people_(world_, options.wanderers, options.seed),
      laser_random_(random_for(options, "laser")),
      sonar_random_(random_for(options, "sonar")),
      slip_random_(random_for(options, "slip")),
      errors_(of_robot(options.odometry), random_for(options, "odometry")),
      T_world_robot_(*options_.T_world_start) {
  for (std::size_t i = 0; i < world_.changing.size(); ++i) {
    world::ChangingPart& part = world_.changing[i];
    if (!part.random) continue;
    turns_.push_back({i, world::DrawnTurns(*part.random, options.seed, i)});
    part.present_s.push_back(turns_.back().drawn.next());
    part.random.reset();
  }
  change_world();
  if (overlapped_) {
    throw std::invalid_argument(world_.name + ": the robot overlaps something at its start, (" +
                                std::to_string(T_world_robot_.x_m) + ", " +
                                std::to_string(T_world_robot_.y_m) + ")");
  }
}

EncoderStep SimulatedRobot::step(const Velocity& command, double dt_s) {
  check_robot(std::isfinite(command.linear_m_per_s) && std::isfinite(command.angular_rad_per_s),
              "velocity", "finite numbers");
  check_robot(std::isfinite(dt_s) && dt_s >= 0.0, "dt_s", "a number >= 0");
  // A slight excess over a whole number of pieces is rounding.
  const double pieces = std::max(1.0, std::ceil(dt_s / kPiece_s - 1e-6));
  EncoderStep sum;
  for (double i = 0.0; i < pieces; i += 1.0) {
    const EncoderStep piece = advance(command, dt_s / pieces);
    sum.forward_m += piece.forward_m;
    sum.turn_rad += piece.turn_rad;
  }
  return sum;
}

EncoderStep SimulatedRobot::advance(const Velocity& command, double dt_s) {
  velocity_.linear_m_per_s = towards(velocity_.linear_m_per_s, command.linear_m_per_s,
                                     options_.acceleration_m_per_s2 * dt_s);
  velocity_.angular_rad_per_s = towards(velocity_.angular_rad_per_s, command.angular_rad_per_s,
                                        options_.angular_acceleration_rad_per_s2 * dt_s);
  velocity_ = geometry::drivable(velocity_, options_.minimum_turning_radius_m);
  const double rolled_m = velocity_.linear_m_per_s * dt_s;
  const double turned_rad = velocity_.angular_rad_per_s * dt_s;
  const double hold = 1.0 - lost_share(std::fabs(rolled_m));
  const geometry::Pose2 wanted = with_errors(arc(hold * rolled_m, turned_rad));
  const geometry::SinCos heading = geometry::sincos(T_world_robot_.theta_rad);
  const Eigen::Vector2d displacement_m(heading.cos * wanted.x_m - heading.sin * wanted.y_m,
                                       heading.sin * wanted.x_m + heading.cos * wanted.y_m);
  const bool outlined = !options_.footprint.empty();
  const double share =
      outlined ? go_outlined(displacement_m, wanted.theta_rad) : go(displacement_m);
  const double turned = outlined || options_.minimum_turning_radius_m > 0.0 ? share : 1.0;
  T_world_robot_.theta_rad =
      geometry::wrap_angle(T_world_robot_.theta_rad + turned * wanted.theta_rad);
  if (share < 1.0) velocity_.linear_m_per_s = 0.0;
  if (turned < 1.0) velocity_.angular_rad_per_s = 0.0;
  path_m_ += std::fabs(rolled_m) * share;
  time_s_ += dt_s;
  change_world();
  const EncoderStep counted{rolled_m * share, turned_rad * turned};
  T_odom_robot_ = T_odom_robot_ * arc(counted.forward_m, counted.turn_rad);
  return counted;
}

// Real motion of the robot for an error-free step of its wheels.
geometry::Pose2 SimulatedRobot::with_errors(const geometry::Pose2& step) {
  errors_.carry({});
  const geometry::Pose2 T_sum_now = errors_.advance(step);
  return geometry::between(std::exchange(T_sum_last_, T_sum_now), T_sum_now);
}

double SimulatedRobot::go(const Eigen::Vector2d& displacement_m) {
  const double length_m = displacement_m.norm();
  if (length_m == 0.0) return 1.0;
  const Eigen::Vector2d from_m = T_world_robot_.position_m();
  const Eigen::Vector2d direction = displacement_m / length_m;
  FreePath path{length_m, {}};
  if (length_m > surely_free_m_) {
    surely_free_m_ = std::max(clearance_m(scene_, from_m) - options_.radius_m, 0.0);
    if (length_m > surely_free_m_) {
      path = free_path(scene_, from_m, direction, length_m, options_.radius_m);
    }
  }
  const FreePath among_people =
      free_path(people_scene_, from_m, direction, path.distance_m, options_.radius_m);
  if (among_people.contact_m) path = among_people;
  T_world_robot_.x_m += direction.x() * path.distance_m;
  T_world_robot_.y_m += direction.y() * path.distance_m;
  surely_free_m_ -= path.distance_m;
  if (path.contact_m && !stopped_) ++collisions_;
  contact_m_ = path.contact_m;
  stopped_ = path.contact_m.has_value();
  return path.contact_m ? path.distance_m / length_m : 1.0;
}

double SimulatedRobot::go_outlined(const Eigen::Vector2d& displacement_m, double turn_rad) {
  geometry::Pose2 there = T_world_robot_;
  there.x_m += displacement_m.x();
  there.y_m += displacement_m.y();
  there.theta_rad += turn_rad;
  // A body that already overlaps something may leave it.
  contact_m_ = overlap_at(T_world_robot_) ? std::nullopt : overlap_at(there);
  if (contact_m_ && !stopped_) ++collisions_;
  stopped_ = contact_m_.has_value();
  if (stopped_) return 0.0;
  T_world_robot_.x_m = there.x_m;
  T_world_robot_.y_m = there.y_m;
  return 1.0;
}

std::optional<Eigen::Vector2d> SimulatedRobot::overlap_at(const geometry::Pose2& pose) const {
  const auto among_people = overlap_m(people_scene_, pose, options_.footprint);
  return among_people ? among_people : overlap_m(scene_, pose, options_.footprint);
}

double SimulatedRobot::lost_share(double rolled_m) {
  const bool begins = slip_random_.uniform() < options_.slip.per_m * rolled_m;
  if (slippery_m_ <= 0.0 && begins) slippery_m_ = options_.slip.length_m;
  if (slippery_m_ <= 0.0) return 0.0;
  slippery_m_ -= rolled_m;
  return options_.slip.lost_share;
}

void SimulatedRobot::carry(const geometry::Pose2& T_world_robot) {
  T_world_robot_ = T_world_robot;
  surely_free_m_ = 0.0;
  stopped_ = false;
  contact_m_.reset();
  look_for_overlap();
}

void SimulatedRobot::draw_turns() {
  for (Turns& turns : turns_) {
    world::TimeInterval& turn = world_.changing[turns.part].present_s.back();
    while (turn.to_s <= time_s_) turn = turns.drawn.next();
  }
}

void SimulatedRobot::change_world() {
  draw_turns();
  std::vector<bool> present = present_parts(world_, path_m_, time_s_);
  if (present != present_ || scene_.segments.size() + scene_.circles.size() == 0) {
    scene_ = scene_at(world_, path_m_, time_s_);
    present_ = std::move(present);
    surely_free_m_ = 0.0;
  }
  people_.walk(time_s_, scene_, T_world_robot_.position_m());
  people_scene_.circles = people_.circles();
  look_for_overlap();
}

void SimulatedRobot::look_for_overlap() {
  const Eigen::Vector2d here_m = T_world_robot_.position_m();
  const bool outlined = !options_.footprint.empty();
  std::optional<Eigen::Vector2d> contact_m =
      outlined ? overlap_at(T_world_robot_) : overlap_m(people_scene_, here_m, options_.radius_m);
  if (!outlined && !contact_m && surely_free_m_ <= 0.0) {
    contact_m = overlap_m(scene_, here_m, options_.radius_m);
  }
  if (contact_m && !overlapped_) ++run_into_;
  if (contact_m || !stopped_) contact_m_ = contact_m;
  overlapped_ = contact_m.has_value();
}

std::optional<double> SimulatedRobot::bumped_rad() const {
  if (!contact_m_) return std::nullopt;
  const Eigen::Vector2d there_m = geometry::inverse(T_world_robot_) * *contact_m_;
  return geometry::atan2(there_m.y(), there_m.x());
}

double SimulatedRobot::free_ahead_m(double limit_m) const {
  const geometry::SinCos heading = geometry::sincos(T_world_robot_.theta_rad);
  const Eigen::Vector2d direction(heading.cos, heading.sin);
  const Eigen::Vector2d from_m = T_world_robot_.position_m();
  const double distance_m =
      free_path(scene_, from_m, direction, limit_m, options_.radius_m).distance_m;
  return free_path(people_scene_, from_m, direction, distance_m, options_.radius_m).distance_m;
}

world::World SimulatedRobot::scene() const {
  world::World all = scene_;
  all.circles.insert(all.circles.end(), people_scene_.circles.begin(), people_scene_.circles.end());
  return all;
}

std::vector<double> SimulatedRobot::exact_scan_m(const BeamPattern& beams) const {
  const geometry::Pose2 T_world_laser = T_world_robot_ * options_.T_robot_laser;
  std::vector<double> ranges_m = raycast(scene_, T_world_laser, beams);
  if (people_scene_.circles.empty()) return ranges_m;
  const std::vector<double> people_m = raycast(people_scene_, T_world_laser, beams);
  for (std::size_t i = 0; i < ranges_m.size(); ++i)
    ranges_m[i] = std::min(ranges_m[i], people_m[i]);
  return ranges_m;
}

std::vector<float> SimulatedRobot::scan(const BeamPattern& beams) {
  return measure(exact_scan_m(beams), options_.laser, laser_random_);
}

std::vector<float> SimulatedRobot::sonar() {
  std::vector<Echo> echoes;
  echoes.reserve(options_.sonars.size());
  for (const devices::SonarMount& sonar : options_.sonars) {
    const geometry::Pose2 T_world_sonar = T_world_robot_ * sonar.T_robot_sonar;
    const Echo surface =
        echo(scene_, T_world_sonar, sonar.half_cone_rad, options_.sonar.range_max_m);
    const Echo person =
        echo(people_scene_, T_world_sonar, sonar.half_cone_rad, options_.sonar.range_max_m);
    echoes.push_back(person.range_m < surface.range_m ? person : surface);
  }
  return measure(echoes, options_.sonar, sonar_random_);
}

}  // namespace topogeo::simulation
