// The movement model: effect of each motion primitive on the probabilities (MACONDO, III.1, figs.
// 4-7).
//
// A transition matrix contains the probabilities that the robot ends this many cells from the
// expected end of the primitive. It is stored as printed in MACONDO, with the motion from left to
// right: rows across the motion, the upper row to the left of the robot; columns along it. Its
// middle is the expected place, so the window moves with the robot and the matrix only spreads.
//
// MACONDO prints a matrix for an advance of one cell, none for the turns, and does not state how a
// longer primitive spreads more. Here a matrix describes a step of known length; a primitive of
// several steps applies it repeatedly, and the rest of a step in proportion (see part_of).
#pragma once

#include <numbers>
#include <span>
#include <vector>

#include "topogeo/markov/belief_grid.hpp"
#include "topogeo/markov/markov_config.hpp"

namespace topogeo::markov {

/// Throws std::invalid_argument naming key, value and expectation: sides of a matrix not odd or not
/// in [1, 21], another number of values, values negative or not finite, a sum not in [0.1, 1.01], a
/// step that is neither 0 nor in [0.01, 100] m or [0.01, 6.3] rad.
void check(const TransitionModel& model);

/// One cell of a matrix, turned into the axes of the map.
struct Tap {
  Cell offset;
  double probability = 0.0;
};

/// The nonzero cells of the matrix, turned to the heading of the motion (radians, counter-clockwise
/// from x of the map, |heading_rad| <= 1e5), row after row. Multiples of 90 degrees move the values
/// exactly. At other angles each value is distributed bilinearly to the four cells around its
/// turned place, which keeps the sum and the mean displacement and adds at most a quarter of a
/// squared cell to the variance along x and along y.
std::vector<Tap> turned(const TransitionMatrix& matrix, ArrowSense sense, double heading_rad);

/// The taps for a part of a step, 0 < part <= 1: this part of the probabilities moves, the rest
/// stays.
std::vector<Tap> part_of(const std::vector<Tap>& taps, double part);

/// One movement update: begins an update of the grid and spreads every cell of the previous state
/// by the taps; cells outside `free` (free_cells_of_window of the grid's centre) get zero. Does not
/// normalize: the rest of the returned sum left the window, went into obstacles or was never in the
/// matrix.
double spread(std::span<const Tap> taps, std::span<const RowBits> free, BeliefGrid& grid);

}  // namespace topogeo::markov
