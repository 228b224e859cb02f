// People who walk about while the robot drives: discs visible to the laser.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "topogeo/support/random.hpp"
#include "topogeo/world/world.hpp"

namespace topogeo::simulation {

/// Position of a person on its path at a time since the start of the drive, without any waiting.
Eigen::Vector2d position_m(const world::Person& person, double time_s);

/// The people of a world plus `wanderers`, who walk about at random.
class People {
 public:
  /// The world must outlive this object. Wanderers start near its tour, at least 3 m from its start
  /// if possible. The seed determines their places, speeds and paths.
  People(const world::World& world, std::size_t wanderers, std::uint64_t seed);

  /// Lets them walk until `time_s`, which never goes back, in a scene (scene_at) with the robot.
  void walk(double time_s, const world::World& scene, const Eigen::Vector2d& robot_m);

  /// Everybody at their present place.
  [[nodiscard]] std::vector<world::Circle> circles() const;

 private:
  struct Wanderer {
    Eigen::Vector2d position_m;
    Eigen::Vector2d direction;  // of unit length
    double speed_m_per_s = 1.0;
    support::Random random;
  };
  static void step(Wanderer& wanderer, const world::World& scene, const Eigen::Vector2d& robot_m);

  const world::World& world_;
  std::vector<Wanderer> wanderers_;
  // Lets a person who yields walk from step `steps_` to the next one, or wait.
  void yield(std::size_t person, const Eigen::Vector2d& robot_m);

  std::vector<double> waited_s_;  // by the people of the world
  double time_s_ = 0.0;
  std::uint64_t steps_ = 0;
};

}  // namespace topogeo::simulation
