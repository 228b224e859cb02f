// A robot driven through a world by velocities: it collides, slips, counts its wheels' turns with
// errors, and measures by laser and sonar. A step costs microseconds, so that whole series of
// drives run in one process. The same arguments and calls give the same results to the last bit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "topogeo/devices/sonar_ring.hpp"
#include "topogeo/geometry/footprint.hpp"
#include "topogeo/geometry/pose2.hpp"
#include "topogeo/simulation/laser.hpp"
#include "topogeo/simulation/odometry.hpp"
#include "topogeo/simulation/people.hpp"
#include "topogeo/simulation/sonar.hpp"
#include "topogeo/simulation/tour_follower.hpp"
#include "topogeo/support/random.hpp"
#include "topogeo/world/world.hpp"

namespace topogeo::simulation {

/// The wheels occasionally lose grip for a while.
struct Slip {
  double per_m = 0.0;       ///< mean frequency of slippery parts; [0, 10]
  double length_m = 0.1;    ///< of such a part, as the wheels roll; (0, 10]
  double lost_share = 0.5;  ///< of the distance rolled there; [0, 1]
};

struct RobotOptions {
  std::uint64_t seed = 1;
  /// None: at the start of the world's tour, heading along it.
  std::optional<geometry::Pose2> T_world_start{};
  double radius_m = devices::kB21Radius_m;  ///< of its round body; (0, 5]
  geometry::Footprint footprint{};          ///< of a body that is not round
  double minimum_turning_radius_m = 0.0;    ///< above 0 it cannot turn on the spot; [0, 10]
  double acceleration_m_per_s2 = std::numeric_limits<double>::infinity();            ///< > 0
  double angular_acceleration_rad_per_s2 = std::numeric_limits<double>::infinity();  ///< > 0
  /// Difference between the distance that its wheels count and the one that it drives. They count
  /// the commanded motion; the robot's motion has the errors.
  OdometryDrift odometry{};
  Slip slip{};
  BeamPattern beams{};
  LaserNoise laser{};
  geometry::Pose2 T_robot_laser{};
  std::vector<devices::SonarMount> sonars = devices::b21_sonars();
  SonarNoise sonar{};
  std::size_t wanderers = 0;  ///< people besides those of the world, see People
};

/// Motion counted by the wheels: forward and counter-clockwise.
struct EncoderStep {
  double forward_m = 0.0;
  double turn_rad = 0.0;
};

class SimulatedRobot {
 public:
  /// Throws std::invalid_argument for an option out of range, a world without a tour if no start is
  /// given, and a start where the robot overlaps something.
  SimulatedRobot(world::World world, const RobotOptions& options);
  SimulatedRobot(const SimulatedRobot&) = delete;
  SimulatedRobot& operator=(const SimulatedRobot&) = delete;

  /// Drives for `dt_s` (>= 0, in pieces of at most 20 ms) as commanded. A contact stops motion
  /// towards it, but neither a turn nor motion away from it; a body that is not round and a base
  /// that cannot turn on the spot also end a turn at a contact. Throws std::invalid_argument for a
  /// velocity or time that is not finite.
  EncoderStep step(const Velocity& command, double dt_s);

  /// Lifts the robot and puts it down there; its wheels do not turn.
  void carry(const geometry::Pose2& T_world_robot);

  [[nodiscard]] const geometry::Pose2& T_world_robot() const { return T_world_robot_; }
  /// Sum of the encoder steps, starting with the identity: each step as half its turn, forward, the
  /// other half.
  [[nodiscard]] const geometry::Pose2& T_odom_robot() const { return T_odom_robot_; }
  /// Present velocity of the wheels.
  [[nodiscard]] const Velocity& velocity() const { return velocity_; }
  [[nodiscard]] double time_s() const { return time_s_; }
  [[nodiscard]] double path_m() const { return path_m_; }  ///< rolled distance, there and back

  /// Readings of the laser here and now, one per beam; scan::Scan::kNoReturn for none.
  std::vector<float> scan() { return scan(options_.beams); }
  /// The same along other beams.
  std::vector<float> scan(const BeamPattern& beams);
  /// The same without noise; infinity for none.
  [[nodiscard]] std::vector<double> exact_scan_m() const { return exact_scan_m(options_.beams); }
  [[nodiscard]] std::vector<double> exact_scan_m(const BeamPattern& beams) const;
  /// Readings of the sonars here and now; scan::Scan::kNoReturn for none.
  std::vector<float> sonar();

  /// Direction, relative to its heading, of a contact that has stopped it or run into it, until it
  /// moves away; nothing without a contact.
  [[nodiscard]] std::optional<double> bumped_rad() const;
  /// Number of its own motions that ended at an obstacle.
  [[nodiscard]] std::uint64_t collisions() const { return collisions_; }
  /// Number of times that a person or a door has run into it.
  [[nodiscard]] std::uint64_t run_into() const { return run_into_; }
  /// Free distance straight ahead until it touches something, at most `limit_m`.
  [[nodiscard]] double free_ahead_m(double limit_m) const;

  /// Everything that is present now, including people.
  [[nodiscard]] world::World scene() const;
  [[nodiscard]] const RobotOptions& options() const { return options_; }

 private:
  EncoderStep advance(const Velocity& command, double dt_s);
  /// Moves up to `displacement_m`; returns the free share of it.
  double go(const Eigen::Vector2d& displacement_m);
  /// The same for a body with an outline, which may also not turn into things: it moves the whole
  /// step or not at all.
  double go_outlined(const Eigen::Vector2d& displacement_m, double turn_rad);
  /// The point that overlaps the body at a pose.
  [[nodiscard]] std::optional<Eigen::Vector2d> overlap_at(const geometry::Pose2& pose) const;
  double lost_share(double rolled_m);
  geometry::Pose2 with_errors(const geometry::Pose2& step);
  void change_world();
  void look_for_overlap();

  /// A part that changes at random; the world only has its interval that is not over yet.
  struct Turns {
    std::size_t part;
    world::DrawnTurns drawn;
  };
  void draw_turns();

  RobotOptions options_;
  world::World world_;
  std::vector<Turns> turns_;
  world::World scene_;  // without people
  world::World people_scene_;
  std::vector<bool> present_;
  People people_;
  support::Random laser_random_;
  support::Random sonar_random_;
  support::Random slip_random_;
  OdometryModel errors_;

  geometry::Pose2 T_world_robot_;
  geometry::Pose2 T_sum_last_;  // of all steps with their errors
  geometry::Pose2 T_odom_robot_;
  Velocity velocity_;
  double time_s_ = 0.0;
  double path_m_ = 0.0;
  double slippery_m_ = 0.0;     // rest of the present slippery part
  double surely_free_m_ = 0.0;  // motion up to this length touches nothing of scene_
  std::optional<Eigen::Vector2d> contact_m_;
  std::uint64_t collisions_ = 0;
  std::uint64_t run_into_ = 0;
  bool stopped_ = false;     // an obstacle ended the last piece of motion
  bool overlapped_ = false;  // an obstacle overlaps the robot
};

}  // namespace topogeo::simulation
