// A drive of a laser that a person carries: fast turns, a scan ten times a second, a range of 12 m,
// no odometry.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <utility>

#include "topogeo/matching/laser_odometry.hpp"
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

/// Scans of a laser that measures its beams one after the other during a tenth of a second: each
/// scan of that time gives its part of the beams. Stamp and true pose are those of the middle.
inline simulation::SimulatedLog skewed(simulation::SimulatedLog ticks, bool times_known) {
  constexpr std::int64_t kPeriod_ns = 100'000'000;
  simulation::SimulatedLog log;
  std::size_t end = 0;
  for (std::size_t first = 0; first < ticks.scans.size(); first = end) {
    const std::int64_t first_ns = ticks.scans[first].stamp_ns;
    while (end < ticks.scans.size() && ticks.scans[end].stamp_ns < first_ns + kPeriod_ns) ++end;
    const std::size_t parts = end - first;
    const std::size_t middle = first + parts / 2;
    scan::Scan& scan = log.scans.emplace_back(ticks.scans[middle]);
    log.T_world_robot.push_back(ticks.T_world_robot[middle]);
    scan.T_odom_robot = {};
    scan.sequence = log.scans.size() - 1;
    const std::size_t beams = scan.ranges_m.size();
    for (std::size_t beam = 0; beam < beams; ++beam) {
      scan.ranges_m[beam] = ticks.scans[first + beam * parts / beams].ranges_m[beam];
    }
    if (!times_known) continue;
    const std::int64_t last_ns = ticks.scans[end - 1].stamp_ns;
    scan.first_beam_s = 1e-9 * static_cast<double>(first_ns - scan.stamp_ns);
    scan.beam_step_s = 1e-9 * static_cast<double>(last_ns - first_ns) / static_cast<double>(beams);
  }
  return log;
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
