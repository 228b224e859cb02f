// Buffers of a match, kept to save allocations.
#pragma once

#include <vector>

#include "topogeo/matching/fitness_forms.hpp"
#include "topogeo/matching/matcher.hpp"

#include "genetic_search.hpp"
#include "genetic_search_hypotheses.hpp"

namespace topogeo::localization {

struct Matcher::Buffers {
  FitnessForms forms;
  BranchHypotheses hypotheses;
  GeneticSearch search;
  std::vector<MatchSolution> starts;
};

}  // namespace topogeo::localization
