#include "topogeo/simulation/random_floors.hpp"

#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

#include "topogeo/support/seed.hpp"

#include "floor_plan.hpp"

namespace topogeo::simulation {
namespace {

using Point = Eigen::Vector2d;
const Point kEast(1.0, 0.0);
const Point kNorth(0.0, 1.0);

// A rectangle parallel to the axes.
struct Rectangle {
  Point low_m;
  Point high_m;

  [[nodiscard]] Point low_right_m() const { return {high_m.x(), low_m.y()}; }
  [[nodiscard]] Point high_left_m() const { return {low_m.x(), high_m.y()}; }
  [[nodiscard]] Rectangle grown(double by_m) const {
    return {low_m - Point(by_m, by_m), high_m + Point(by_m, by_m)};
  }
};

// The walls of a block towards the surrounding corridors: rooms in the south and north, shut doors
// in the east and west.
void add_block(const FloorPlan& plan, const Rectangle& block, support::Random& random) {
  const double depth_m = 0.5 * (block.high_m.y() - block.low_m.y()) - 0.2;
  plan.rooms({block.low_m, block.low_right_m(), kNorth}, depth_m, random);
  plan.rooms({block.high_left_m(), block.high_m, -kNorth}, depth_m, random);
  plan.shut_doors({block.low_m, block.high_left_m(), kEast}, random);
  plan.shut_doors({block.low_right_m(), block.high_m, -kEast}, random);
}

// Rooms on all sides, outside of the corridors.
void add_surroundings(const FloorPlan& plan, const Rectangle& inside, support::Random& random) {
  const double depth_m = random.uniform(4.0, 6.0);
  plan.rooms({inside.low_m, inside.low_right_m(), -kNorth}, depth_m, random);
  plan.rooms({inside.high_left_m(), inside.high_m, kNorth}, depth_m, random);
  plan.rooms({inside.low_m, inside.high_left_m(), -kEast}, depth_m, random);
  plan.rooms({inside.low_right_m(), inside.high_m, kEast}, depth_m, random);
}

support::Random random_of(const char* floor, std::uint64_t seed) {
  return support::Random(support::derive_seed(seed, floor, {}));
}

}  // namespace

world::World cyclic_floor(std::uint64_t seed) {
  support::Random random = random_of("cyclic floor", seed);
  world::World world;
  world.name = "cyclic floor";
  const double wide_m = random.uniform(26.0, 30.0);  // of the middle line of the corridor
  const double high_m = random.uniform(16.0, 18.0);
  const double half_m = random.uniform(1.1, 1.3);  // of the corridor's width
  const Rectangle middle{{0.0, 0.0}, {wide_m, high_m}};
  const FloorPlan plan(world);
  add_block(plan, middle.grown(-half_m), random);
  add_surroundings(plan, middle.grown(half_m), random);
  const double start_m = random.uniform(4.0, 8.0);
  world.tour_m = {{start_m, 0.0}, {wide_m, 0.0}, {wide_m, high_m}, {0.0, high_m},
                  {0.0, 0.0},     {wide_m, 0.0}, {wide_m, 3.0}};
  return world;
}

world::World corridor_there_and_back(std::uint64_t seed) {
  support::Random random = random_of("corridor", seed);
  world::World world;
  world.name = "corridor there and back";
  const double long_m = random.uniform(30.0, 42.0);
  const double half_m = random.uniform(1.0, 1.3);
  const double depth_m = random.uniform(4.0, 6.0);
  const FloorPlan plan(world);
  plan.rooms({{0.0, -half_m}, {long_m, -half_m}, -kNorth}, depth_m, random);
  plan.rooms({{0.0, half_m}, {long_m, half_m}, kNorth}, depth_m, random);
  plan.line({0.0, -half_m}, {0.0, half_m});
  plan.line({long_m, -half_m}, {long_m, half_m});
  world.tour_m = {{1.5, 0.0}, {long_m - 1.5, 0.0}, {1.5, 0.0}};
  return world;
}

world::World two_loops(std::uint64_t seed) {
  support::Random random = random_of("two loops", seed);
  world::World world;
  world.name = "two loops";
  const double left_m = random.uniform(14.0, 18.0);
  const double right_m = left_m + random.uniform(14.0, 18.0);
  const double high_m = random.uniform(12.0, 15.0);
  const double half_m = random.uniform(1.1, 1.3);
  const FloorPlan plan(world);
  add_block(plan, Rectangle{{0.0, 0.0}, {left_m, high_m}}.grown(-half_m), random);
  add_block(plan, Rectangle{{left_m, 0.0}, {right_m, high_m}}.grown(-half_m), random);
  add_surroundings(plan, Rectangle{{0.0, 0.0}, {right_m, high_m}}.grown(half_m), random);
  world.tour_m = {{2.0, 0.0},     {left_m, 0.0},     {left_m, high_m}, {0.0, high_m}, {0.0, 0.0},
                  {right_m, 0.0}, {right_m, high_m}, {left_m, high_m}, {left_m, 0.0}, {2.0, 0.0}};
  return world;
}

world::World bare_corridor(std::uint64_t seed) {
  support::Random random = random_of("bare corridor", seed);
  world::World world;
  world.name = "bare corridor";
  const double long_m = random.uniform(34.0, 42.0);
  const double half_m = random.uniform(1.0, 1.3);
  const double hall_m = random.uniform(5.0, 7.0);       // length of each hall
  const double hall_half_m = random.uniform(2.5, 3.5);  // of its width
  const FloorPlan plan(world);
  for (const double side : {-1.0, 1.0}) {
    plan.line({0.0, side * half_m}, {long_m, side * half_m});
    for (const double end_m : {0.0, long_m}) {
      const double back_m = end_m == 0.0 ? -hall_m : long_m + hall_m;
      plan.line({end_m, side * half_m}, {end_m, side * hall_half_m});
      plan.line({end_m, side * hall_half_m}, {back_m, side * hall_half_m});
    }
  }
  for (const double back_m : {-hall_m, long_m + hall_m}) {
    plan.line({back_m, -hall_half_m}, {back_m, hall_half_m});
    const double low_m = back_m < 0.0 ? back_m : long_m;
    plan.furnish({low_m, -hall_half_m}, {low_m + hall_m, hall_half_m}, random);
  }
  const double west_m = 1.5 - hall_m;
  const double east_m = long_m + hall_m - 1.5;
  world.tour_m = {{west_m, 0.0}, {east_m, 0.0}, {west_m, 0.0}};
  return world;
}

world::World symmetric_building(std::uint64_t seed) {
  support::Random random = random_of("symmetric building", seed);
  world::World world;
  world.name = "symmetric building";
  const double apart_m = random.uniform(13.0, 16.0);
  const double wing_m = random.uniform(11.0, 14.0);
  const double half_m = random.uniform(1.0, 1.25);
  const double depth_m = 0.5 * apart_m - half_m - 0.2;
  const FloorPlan plan(world);
  for (const double west_m : {0.0, apart_m}) {
    support::Random copy = random;  // identical draws for both
    const double east_m = west_m + apart_m;
    const double wing_west_m = west_m + 0.5 * apart_m - half_m;
    const double wing_east_m = wing_west_m + 2.0 * half_m;
    const double top_m = half_m + wing_m;
    plan.rooms({{west_m, -half_m}, {east_m, -half_m}, -kNorth}, 5.0, copy);
    plan.shut_doors({{west_m, half_m}, {wing_west_m, half_m}, kNorth}, copy);
    plan.shut_doors({{wing_east_m, half_m}, {east_m, half_m}, kNorth}, copy);
    plan.rooms({{wing_west_m, half_m}, {wing_west_m, top_m}, -kEast}, depth_m, copy);
    plan.rooms({{wing_east_m, half_m}, {wing_east_m, top_m}, kEast}, depth_m, copy);
    plan.line({wing_west_m, top_m}, {wing_east_m, top_m});
  }
  plan.line({0.0, -half_m}, {0.0, half_m});
  plan.line({2.0 * apart_m, -half_m}, {2.0 * apart_m, half_m});
  const double first_m = 0.5 * apart_m;
  const double second_m = 1.5 * apart_m;
  const double end_m = half_m + wing_m - 1.5;
  world.tour_m = {{1.5, 0.0},      {first_m, 0.0},    {first_m, end_m}, {first_m, 0.0},
                  {second_m, 0.0}, {second_m, end_m}, {second_m, 0.0},  {2.0 * apart_m - 1.5, 0.0},
                  {1.5, 0.0}};
  return world;
}

world::World long_corridors(std::uint64_t seed) {
  support::Random random = random_of("long corridors", seed);
  world::World world;
  world.name = "long corridors";
  const double around_m = random.uniform(100.0, 500.0);
  const double high_m = random.uniform(0.06, 0.1) * around_m + random.uniform(6.0, 10.0);
  const double wide_m = 0.5 * around_m - high_m;
  const double middle_m = random.uniform(0.35, 0.65) * wide_m;
  const double half_m = random.uniform(1.0, 1.3);
  const FloorPlan plan(world);
  add_block(plan, Rectangle{{0.0, 0.0}, {middle_m, high_m}}.grown(-half_m), random);
  add_block(plan, Rectangle{{middle_m, 0.0}, {wide_m, high_m}}.grown(-half_m), random);
  add_surroundings(plan, Rectangle{{0.0, 0.0}, {wide_m, high_m}}.grown(half_m), random);
  const double start_m = random.uniform(4.0, 0.5 * middle_m);
  world.tour_m = {{start_m, 0.0},  {wide_m, 0.0},      {wide_m, high_m}, {0.0, high_m},  {0.0, 0.0},
                  {middle_m, 0.0}, {middle_m, high_m}, {wide_m, high_m}, {wide_m, 0.0},  {0.0, 0.0},
                  {0.0, high_m},   {wide_m, high_m},   {wide_m, 0.0},    {middle_m, 0.0}};
  return world;
}

world::World large_floor(std::uint64_t seed, double path_m, std::size_t blocks) {
  if (!(path_m >= 50.0 && path_m <= 20'000.0)) {
    throw std::invalid_argument("path_m: expected a number in [50, 20000], got " +
                                std::to_string(path_m));
  }
  if (blocks < 1 || blocks > 40) {
    throw std::invalid_argument("blocks: expected a number in [1, 40], got " +
                                std::to_string(blocks));
  }
  support::Random random = random_of("large floor", seed);
  world::World world;
  world.name = "large floor";
  const double half_m = 1.2;
  std::vector<double> x_m(blocks + 1);  // middle lines of the streets
  std::vector<double> y_m(blocks + 1);
  for (std::size_t i = 0; i < blocks; ++i) {
    x_m[i + 1] = x_m[i] + random.uniform(16.0, 22.0);
    y_m[i + 1] = y_m[i] + random.uniform(12.0, 16.0);
  }
  const FloorPlan plan(world);
  for (std::size_t i = 0; i < blocks; ++i) {
    for (std::size_t k = 0; k < blocks; ++k) {
      add_block(plan, Rectangle{{x_m[i], y_m[k]}, {x_m[i + 1], y_m[k + 1]}}.grown(-half_m), random);
    }
  }
  add_surroundings(plan, Rectangle{{0.0, 0.0}, {x_m[blocks], y_m[blocks]}}.grown(half_m), random);

  using Crossing = std::pair<std::size_t, std::size_t>;
  Crossing before{0, 0};
  Crossing here{0, 0};
  const auto place_m = [&](const Crossing& c) { return Point(x_m[c.first], y_m[c.second]); };
  world.tour_m.push_back(place_m(here));
  double driven_m = 0.0;
  while (driven_m < path_m) {
    std::vector<Crossing> ways;
    if (here.first > 0) ways.emplace_back(here.first - 1, here.second);
    if (here.first < blocks) ways.emplace_back(here.first + 1, here.second);
    if (here.second > 0) ways.emplace_back(here.first, here.second - 1);
    if (here.second < blocks) ways.emplace_back(here.first, here.second + 1);
    std::erase(ways, before);
    const Crossing next = ways[random.below(ways.size())];
    driven_m += (place_m(next) - place_m(here)).norm();
    world.tour_m.push_back(place_m(next));
    before = std::exchange(here, next);
  }
  return world;
}

OdometryDrift b21_odometry(std::uint64_t seed) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  support::Random random = random_of("odometry of a B21", seed);
  return {.range_scale_error = random.uniform(-0.03, 0.03),
          .range_sigma_m_per_sqrt_m = 0.057,
          .heading_drift_rad_per_m = random.uniform(-0.25, 0.25) * kDegree,
          .heading_sigma_rad_per_sqrt_m = 2.0 * kDegree,
          .turn_sigma_rad_per_sqrt_rad = 10.0 * kDegree,
          .turn_scale_error = random.uniform(-0.03, 0.03),
          .lateral_sigma_m_per_sqrt_m = 0.037,
          .turn_shift_sigma_m_per_sqrt_rad = 0.039};
}

}  // namespace topogeo::simulation
