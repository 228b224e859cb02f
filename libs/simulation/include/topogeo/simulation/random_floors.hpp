// Floors drawn from a seed: lengths, rooms, doors (open, or shut and a little set back), furniture
// and things in the corridors differ from seed to seed, the plan stays. Each with a tour whose
// every point is at least 0.3 m from anything.
#pragma once

#include <cstddef>
#include <cstdint>

#include "topogeo/simulation/odometry.hpp"
#include "topogeo/world/world.hpp"

namespace topogeo::simulation {

/// A corridor round a block of rooms, 84 to 96 m about, driven once round and on over the first
/// quarter: the Thesis's experiment 2.
world::World cyclic_floor(std::uint64_t seed);

/// A corridor of 30 to 42 m with rooms on both sides, driven to its end and back: experiment 1.
world::World corridor_there_and_back(std::uint64_t seed);

/// Two blocks side by side with corridors round both and between them; each is driven round, the
/// corridor between them once with each.
world::World two_loops(std::uint64_t seed);

/// A corridor of 34 to 42 m with nothing on its walls between a hall at each end, driven there and
/// back. Its ends are in range of a laser of 50 m.
world::World bare_corridor(std::uint64_t seed);

/// A corridor with two wings that are copies of each other down to the furniture, 13 to 16 m apart;
/// the corridor before them is the same as well.
world::World symmetric_building(std::uint64_t seed);

/// Two long corridors with rooms on both sides, cross corridors at their ends and between; the ring
/// is 100 to 500 m round. It is driven round, then through the cross corridor and half of it, then
/// all round the other way: about 2.8 times the ring.
world::World long_corridors(std::uint64_t seed);

/// Blocks, so many along each side, with streets of corridor round them; the tour goes about
/// `path_m` metres through them, at each crossing another path than the one it came. `path_m` in
/// [50, 20000], `blocks` in [1, 40]; throws std::invalid_argument otherwise.
world::World large_floor(std::uint64_t seed, double path_m, std::size_t blocks = 4);

/// Odometry that errs like that of the B21 of a recorded log, whose steps were compared with those
/// of its reference trajectory: random 5.7 cm along and 3.7 cm across for the root of each metre,
/// 2 degrees for the root of each metre, 10 degrees and 3.9 cm for the root of each radian turned.
/// The seed draws what is systematic: up to 3 % of the distance, 0.25 degrees a metre and 3 % of a
/// turn, to either side.
OdometryDrift b21_odometry(std::uint64_t seed);

}  // namespace topogeo::simulation
