// Errors of matches of two stops against their true relative pose, by every form of the fitness,
// and those of odometry.
#pragma once

#include <cstddef>
#include <cstdio>

#include "matching_run.hpp"

namespace topogeo::bench {

void print_accuracy_header(std::FILE* out);

/// Rows of a table for all pairs of stops i, i + `apart` that the reference knows, at most
/// `most_pairs` of them, evenly over the log.
void print_accuracy(std::FILE* out, MatchingRun& run, std::size_t apart, std::size_t most_pairs);

void print_closure_header(std::FILE* out);

/// A row: the closing error of the matches between the stops i, i+1, i+2, against the error of the
/// match of i with i+2 by the reference. Matches are independent, so when they close better than
/// they agree with the reference, the difference is the reference's error.
void print_closure(std::FILE* out, MatchingRun& run, std::size_t most);

}  // namespace topogeo::bench
