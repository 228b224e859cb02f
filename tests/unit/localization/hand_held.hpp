// A drive of a laser that a person carries: fast turns, a scan ten times a second, a range of 12 m,
// no odometry.
#pragma once

#include <algorithm>
#include <numbers>
#include <utility>

#include "topogeo/localization/tracking/laser_odometry.hpp"
#include "topogeo/simulation/simulate_log.hpp"

namespace topogeo::localization::test {

/// The simulation of every tick of 20 ms, to be thinned by every_tenth_of_a_second().
inline simulation::SimulationOptions hand_held_options(std::uint64_t seed) {
  simulation::SimulationOptions options;
  options.seed = seed;
  options.scan_step_m = 0.01;
  options.scan_step_rad = 0.01;
  options.drive.speed_m_per_s = 1.2;
  options.drive.turn_rad_per_s = std::numbers::pi / 2.0;
  options.drive.acceleration_m_per_s2 = 1.5;
  options.beams = {-std::numbers::pi, std::numbers::pi / 180.0, 360, 12.0};
  return options;
}

/// The scans a tenth of a second apart, without odometry.
inline simulation::SimulatedLog every_tenth_of_a_second(simulation::SimulatedLog log) {
  constexpr std::int64_t kPeriod_ns = 100'000'000;
  simulation::SimulatedLog thinned;
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    if (!thinned.scans.empty() &&
        log.scans[i].stamp_ns < thinned.scans.back().stamp_ns + kPeriod_ns) {
      continue;
    }
    log.scans[i].T_odom_robot = {};
    log.scans[i].sequence = thinned.scans.size();
    thinned.scans.push_back(std::move(log.scans[i]));
    thinned.T_world_robot.push_back(log.T_world_robot[i]);
  }
  return thinned;
}

inline simulation::SimulatedLog hand_held_drive(const world::World& world,
                                                const simulation::SimulationOptions& options) {
  return every_tenth_of_a_second(simulation::simulate_log(world, options));
}

/// The scans that odometry from the scans places, and the truth at each.
struct Followed {
  simulation::SimulatedLog log;
  LaserOdometryCounts counts;
};

inline Followed follow(const simulation::SimulatedLog& log) {
  LaserOdometry odometry({}, 50.0);
  Followed followed;
  const auto take = [&] {
    for (scan::Scan& scan : odometry.take()) {
      const auto given = std::ranges::find(log.scans, scan.stamp_ns, &scan::Scan::stamp_ns);
      followed.log.T_world_robot.push_back(
          log.T_world_robot[static_cast<std::size_t>(given - log.scans.begin())]);
      followed.log.scans.push_back(std::move(scan));
    }
  };
  for (const scan::Scan& scan : log.scans) {
    odometry.add(scan);
    take();
  }
  odometry.finish();
  take();
  followed.counts = odometry.counts();
  return followed;
}

}  // namespace topogeo::localization::test
