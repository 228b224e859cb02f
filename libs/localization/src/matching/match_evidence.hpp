// All that a match result states of its poses, computed in one place for solve() and verify().
#pragma once

#include "topogeo/localization/matching/fitness_forms.hpp"
#include "topogeo/localization/matching/match.hpp"
#include "topogeo/localization/matching/match_features.hpp"
#include "topogeo/localization/matching/refinement.hpp"

namespace topogeo::localization {

/// Throws std::invalid_argument, naming the task and the number, when a number of the task is not
/// finite or outside of what is allowed. A task may come from another machine, so nothing of it is
/// taken on trust.
void check(const MatchTask& task);

/// What a result is computed from; the features are those that MatchTask::evidence reads.
struct MatchContext {
  const MatchTask& task;
  const Reference& reference;
  const MatchFeatures& query;
  const FitnessForms& forms;
};

/// Places that are refined before the winner is chosen. Fixed: tasks do not carry it.
inline constexpr std::size_t kRefined = 3;

/// Whether two poses are so near each other that refinement takes both to one: within 0.3 m and
/// 0.15 rad.
bool same_place(const geometry::Pose2& a, const geometry::Pose2& b);

/// Sets every field of `result` that follows from the task and the poses in it: those of the
/// solutions, the refined one and that of `second`, which counts when its fitness is above 0. Only
/// the poses themselves and `evaluations` stay as they are. Without a solution of a fitness above 0
/// nothing else is left either. The poses must be finite, their headings in [-pi, pi].
void add_evidence(const MatchContext& context, MatchResult& result);

}  // namespace topogeo::localization
