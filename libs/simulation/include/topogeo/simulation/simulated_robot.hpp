// A robot that velocities drive through a world: it collides, slips and counts its wheels' turns
// with errors, measures by laser and sonar. A step costs microseconds, so that whole series of
// drives run in one process. The same arguments and calls give the same results to the last bit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "topogeo/devices/sonar_ring.hpp"
#include "topogeo/geometry/pose2.hpp"
#include "topogeo/simulation/laser.hpp"
#include "topogeo/simulation/odometry.hpp"
#include "topogeo/simulation/people.hpp"
#include "topogeo/simulation/sonar.hpp"
#include "topogeo/simulation/tour_follower.hpp"
#include "topogeo/support/random.hpp"
#include "topogeo/world/world.hpp"

namespace topogeo::simulation {

/// Now and then the wheels find less hold for a while.
struct Slip {
  double per_m = 0.0;       ///< how often begins a slippery stretch, on the average; [0, 10]
  double length_m = 0.1;    ///< of such a stretch, as the wheels roll; (0, 10]
  double lost_share = 0.5;  ///< of the distance rolled there; [0, 1]
};

struct RobotOptions {
  std::uint64_t seed = 1;
  /// Nothing: at the start of the world's tour, heading along it.
  std::optional<geometry::Pose2> T_world_start{};
  double radius_m = devices::kB21Radius_m;  ///< of its round body; (0, 5]
  double acceleration_m_per_s2 = std::numeric_limits<double>::infinity();            ///< > 0
  double angular_acceleration_rad_per_s2 = std::numeric_limits<double>::infinity();  ///< > 0
  /// How the distance that its wheels count differs from the one that it drives. They count what is
  /// commanded; the robot makes the difference.
  OdometryDrift odometry{};
  Slip slip{};
  BeamPattern beams{};
  LaserNoise laser{};
  geometry::Pose2 T_robot_laser{};
  std::vector<devices::SonarMount> sonars = devices::b21_sonars();
  SonarNoise sonar{};
  std::size_t wanderers = 0;  ///< people besides those of the world, see People
};

/// What the wheels counted: forward and counter-clockwise.
struct EncoderStep {
  double forward_m = 0.0;
  double turn_rad = 0.0;
};

class SimulatedRobot {
 public:
  /// Throws std::invalid_argument for an option out of range, a world without a tour where no start
  /// is given, and a start where the robot overlaps something.
  SimulatedRobot(world::World world, const RobotOptions& options);
  SimulatedRobot(const SimulatedRobot&) = delete;
  SimulatedRobot& operator=(const SimulatedRobot&) = delete;

  /// Drives for `dt_s` (>= 0, worked off in pieces of at most 20 ms) as commanded. A contact stops
  /// the motion ahead, not a turn nor the motion back. Throws std::invalid_argument for a velocity
  /// or time that is no finite number.
  EncoderStep step(const Velocity& command, double dt_s);

  /// It is lifted and put down there; its wheels do not turn.
  void carry(const geometry::Pose2& T_world_robot);

  [[nodiscard]] const geometry::Pose2& T_world_robot() const { return T_world_robot_; }
  /// What the encoder steps add up to, from the identity on: each step goes half its turn, then
  /// forward, then the other half.
  [[nodiscard]] const geometry::Pose2& T_odom_robot() const { return T_odom_robot_; }
  /// Of the wheels, now.
  [[nodiscard]] const Velocity& velocity() const { return velocity_; }
  [[nodiscard]] double time_s() const { return time_s_; }
  [[nodiscard]] double path_m() const { return path_m_; }  ///< rolled, there and back

  /// Readings of the laser here and now, one per beam; scan::Scan::kNoReturn for none.
  std::vector<float> scan();
  /// The same without noise; infinity for none.
  [[nodiscard]] std::vector<double> exact_scan_m() const;
  /// Readings of the sonars here and now; scan::Scan::kNoReturn for none.
  std::vector<float> sonar();

  /// In which direction from its heading it touches what has stopped it or has run into it, until
  /// it moves away; nothing: nowhere.
  [[nodiscard]] std::optional<double> bumped_rad() const;
  /// How often its own motion has ended at something.
  [[nodiscard]] std::uint64_t collisions() const { return collisions_; }
  /// How often a person or a door has run into it.
  [[nodiscard]] std::uint64_t run_into() const { return run_into_; }
  /// How far it could go straight on before it touches something, at most `limit_m`.
  [[nodiscard]] double free_ahead_m(double limit_m) const;

  /// Everything that is there now, people included.
  [[nodiscard]] world::World scene() const;
  [[nodiscard]] const RobotOptions& options() const { return options_; }

 private:
  EncoderStep advance(const Velocity& command, double dt_s);
  /// The share of `displacement_m` that is free.
  double go(const Eigen::Vector2d& displacement_m);
  double lost_share(double rolled_m);
  geometry::Pose2 with_errors(const geometry::Pose2& step);
  void change_world();
  void look_for_overlap();

  /// Something that changes at random: of its times, the world has the one that is not over yet.
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
  double slippery_m_ = 0.0;     // still to come of a slippery stretch
  double surely_free_m_ = 0.0;  // any motion of this length touches nothing of scene_
  std::optional<Eigen::Vector2d> contact_m_;
  std::uint64_t collisions_ = 0;
  std::uint64_t run_into_ = 0;
  bool stopped_ = false;     // the last piece of motion ended at something
  bool overlapped_ = false;  // something stands in the robot
};

}  // namespace topogeo::simulation
