// How near a match of two stops comes to their true relative pose, by every form of the fitness,
// against odometry.
#pragma once

#include <cstddef>
#include <cstdio>

#include "matching_run.hpp"

namespace topogeo::bench {

void print_accuracy_header(std::FILE* out);

/// Rows of a table for all pairs of stops i, i + `apart` of which the reference knows both, at most
/// `most_pairs` of them, evenly over the log.
void print_accuracy(std::FILE* out, MatchingRun& run, std::size_t apart, std::size_t most_pairs);

void print_closure_header(std::FILE* out);

/// A row: how far matches of the stops i, i+1, i+2 with each other are from closing, against how
/// far the match of i with i+2 is from the reference. Matches know nothing of each other, so what
/// closes better than it agrees with the reference says how exact the reference is.
void print_closure(std::FILE* out, MatchingRun& run, std::size_t most);

}  // namespace topogeo::bench
