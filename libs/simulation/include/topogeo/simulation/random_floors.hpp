// Floors drawn from a seed: lengths, rooms, doors (open, or shut and a little set back), furniture
// and obstacles in the corridors differ between seeds, the plan does not. Each has a tour whose
// every point is at least 0.3 m from any surface.
#pragma once

#include <cstddef>
#include <cstdint>

#include "topogeo/simulation/odometry.hpp"
#include "topogeo/world/world.hpp"

namespace topogeo::simulation {

/// A corridor round a block of rooms, about 84 to 96 m, driven once round and on over the first
/// quarter: experiment 2 of the Thesis.
world::World cyclic_floor(std::uint64_t seed);

/// A corridor of 30 to 42 m with rooms on both sides, driven to its end and back: experiment 1 of
/// the Thesis.
world::World corridor_there_and_back(std::uint64_t seed);

/// Two blocks side by side with corridors round both and between them; each is driven round, and
/// the corridor between them once with each.
world::World two_loops(std::uint64_t seed);

/// A corridor of 34 to 42 m with bare walls between a hall at each end, driven there and back. A
/// laser of 50 m sees both ends.
world::World bare_corridor(std::uint64_t seed);

/// A corridor with two wings, 13 to 16 m apart, that are copies of each other including the
/// furniture; the corridor in front of them is also the same.
world::World symmetric_building(std::uint64_t seed);

/// Two long corridors with rooms on both sides, and cross corridors at their ends and between; the
/// ring is 100 to 500 m long. It is driven round, then through the cross corridor and half of it,
/// then round in the other direction: about 2.8 times the ring.
world::World long_corridors(std::uint64_t seed);

/// A grid of blocks, this many along each side, with corridors between them. The tour follows these
/// for about `path_m` metres and leaves each crossing by another path than it came. `path_m` in
/// [50, 20000], `blocks` in [1, 40]; throws std::invalid_argument otherwise.
world::World large_floor(std::uint64_t seed, double path_m, std::size_t blocks = 4);

/// Odometry with the errors of a B21, from a recorded log compared with its reference trajectory:
/// random 5.7 cm along and 3.7 cm across per root of a metre, 2 degrees per root of a metre, 10
/// degrees and 3.9 cm per root of a radian turned. The seed draws the systematic errors: up to 3 %
/// of the distance, 0.25 degrees a metre and 3 % of a turn, of either sign.
OdometryDrift b21_odometry(std::uint64_t seed);

}  // namespace topogeo::simulation
