// All statements of a match result about its poses, computed in one place for solve() and verify().
#pragma once

#include "topogeo/matching/fitness_forms.hpp"
#include "topogeo/matching/match.hpp"
#include "topogeo/matching/match_features.hpp"
#include "topogeo/matching/refinement.hpp"

namespace topogeo::localization {

/// Throws std::invalid_argument, naming the task and the number, if a number of the task is not
/// finite or outside its limits. A task may come from another machine, so nothing in it is trusted.
void check(const MatchTask& task);

/// Input of a result; the features are those that MatchTask::evidence selects.
struct MatchContext {
  const MatchTask& task;
  const Reference& reference;
  const MatchFeatures& query;
  const FitnessForms& forms;
};

/// Number of places refined before the winner is chosen. Fixed: tasks do not carry it.
inline constexpr std::size_t kRefined = 3;

/// Sets every field of `result` that follows from the task and the poses in it: the solutions, the
/// refined pose and, if its fitness is above 0, `second`. The poses and `evaluations` do not
/// change. Without a solution of fitness above 0, all other fields are cleared. The poses must be
/// finite, their headings in [-pi, pi].
void add_evidence(const MatchContext& context, MatchResult& result);

}  // namespace topogeo::localization
