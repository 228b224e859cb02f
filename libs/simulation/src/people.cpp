#include "topogeo/simulation/people.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/support/seed.hpp"

namespace topogeo::simulation {
namespace {

constexpr double kWandererRadius_m = 0.2;  // of legs, at the height of a laser
constexpr double kStep_s = 0.1;            // 15 cm for the fastest, less than a radius
constexpr double kFromRobot_m = 0.8;       // kept by people who yield or wander

Eigen::Vector2d any_direction(support::Random& random) {
  const double angle_rad = random.uniform(-std::numbers::pi, std::numbers::pi);
  const geometry::SinCos direction = geometry::sincos(angle_rad);
  return {direction.cos, direction.sin};
}

// A random place on the tour, evenly distributed along it.
Eigen::Vector2d place_on(const std::vector<Eigen::Vector2d>& tour_m, support::Random& random) {
  double length_m = 0.0;
  for (std::size_t i = 1; i < tour_m.size(); ++i) length_m += (tour_m[i] - tour_m[i - 1]).norm();
  double along_m = random.uniform(0.0, length_m);
  for (std::size_t i = 1; i < tour_m.size(); ++i) {
    const double leg_m = (tour_m[i] - tour_m[i - 1]).norm();
    if (along_m < leg_m) return tour_m[i - 1] + (tour_m[i] - tour_m[i - 1]) * (along_m / leg_m);
    along_m -= leg_m;
  }
  return tour_m.back();
}

}  // namespace

Eigen::Vector2d position_m(const world::Person& person, double time_s) {
  const std::vector<Eigen::Vector2d>& path_m = person.path_m;
  double length_m = 0.0;
  for (std::size_t i = 1; i < path_m.size(); ++i) length_m += (path_m[i] - path_m[i - 1]).norm();
  const double walked_m = std::max(time_s - person.start_s, 0.0) * person.speed_m_per_s;
  if (!(length_m > 0.0) || walked_m == 0.0) return path_m.front();
  const double there_and_back_m = std::fmod(walked_m, 2.0 * length_m);
  double along_m = std::min(there_and_back_m, 2.0 * length_m - there_and_back_m);
  for (std::size_t i = 1; i < path_m.size(); ++i) {
    const double leg_m = (path_m[i] - path_m[i - 1]).norm();
    if (along_m < leg_m) return path_m[i - 1] + (path_m[i] - path_m[i - 1]) * (along_m / leg_m);
    along_m -= leg_m;
  }
  return path_m.back();
}

People::People(const world::World& world, std::size_t wanderers, std::uint64_t seed)
    : world_(world), waited_s_(world.people.size(), 0.0) {
  for (std::size_t i = 0; i < wanderers && !world.tour_m.empty(); ++i) {
    support::Random random(support::derive_seed(seed, "people", {i}));
    Eigen::Vector2d place_m = place_on(world.tour_m, random);
    constexpr int kTries = 20;
    constexpr double kApart_m = 3.0;
    for (int k = 0; k < kTries && (place_m - world.tour_m.front()).norm() < kApart_m; ++k) {
      place_m = place_on(world.tour_m, random);
    }
    const Eigen::Vector2d direction = any_direction(random);
    const double speed_m_per_s = random.uniform(0.5, 1.5);
    wanderers_.push_back({place_m, direction, speed_m_per_s, random});
  }
}

void People::step(Wanderer& wanderer, const world::World& scene, const Eigen::Vector2d& robot_m) {
  constexpr double kFromWalls_m = kWandererRadius_m + 0.1;
  constexpr double kNewMind = 0.01;  // probability of a sudden turn
  const Eigen::Vector2d next_m =
      wanderer.position_m + wanderer.direction * (wanderer.speed_m_per_s * kStep_s);
  const double room_m = clearance_m(scene, next_m);
  // A person who is too near to a surface (a door was shut) may move away from it.
  const bool from_walls =
      room_m >= kFromWalls_m || room_m > clearance_m(scene, wanderer.position_m);
  const double robot_away_m = (next_m - robot_m).norm();
  const bool from_robot =
      robot_away_m >= kFromRobot_m || robot_away_m > (wanderer.position_m - robot_m).norm();
  const bool other_mind = wanderer.random.uniform() < kNewMind;
  if (from_walls && from_robot) wanderer.position_m = next_m;
  if (!from_walls || !from_robot || other_mind) wanderer.direction = any_direction(wanderer.random);
}

void People::yield(std::size_t person, const Eigen::Vector2d& robot_m) {
  const world::Person& walker = world_.people[person];
  const double at_s = static_cast<double>(steps_) * kStep_s - waited_s_[person];
  const double now_m = (position_m(walker, at_s) - robot_m).norm();
  const double next_m = (position_m(walker, at_s + kStep_s) - robot_m).norm();
  if (next_m < kFromRobot_m && next_m < now_m) waited_s_[person] += kStep_s;
}

void People::walk(double time_s, const world::World& scene, const Eigen::Vector2d& robot_m) {
  time_s_ = time_s;
  for (; static_cast<double>(steps_ + 1) * kStep_s <= time_s; ++steps_) {
    for (Wanderer& wanderer : wanderers_) step(wanderer, scene, robot_m);
    for (std::size_t i = 0; i < world_.people.size(); ++i) {
      if (world_.people[i].yields) yield(i, robot_m);
    }
  }
}

std::vector<world::Circle> People::circles() const {
  std::vector<world::Circle> all;
  for (std::size_t i = 0; i < world_.people.size(); ++i) {
    const world::Person& person = world_.people[i];
    const double at_s =
        person.yields ? static_cast<double>(steps_) * kStep_s - waited_s_[i] : time_s_;
    all.push_back({position_m(person, at_s), person.radius_m});
  }
  for (const Wanderer& wanderer : wanderers_) {
    all.push_back({wanderer.position_m, kWandererRadius_m});
  }
  return all;
}

}  // namespace topogeo::simulation
