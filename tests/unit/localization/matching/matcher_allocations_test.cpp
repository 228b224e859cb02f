// Counts the allocations of a match: this program replaces operator new.
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/matching/fitness_forms.hpp"
#include "topogeo/matching/matcher.hpp"

#include "counted_allocations.hpp"
#include "genetic_search.hpp"
#include "genetic_search_hypotheses.hpp"
#include "localization/simulated_maps.hpp"

namespace topogeo::localization {
namespace {

using topogeo::test::allocations;

class Allocations : public testing::Test {
 protected:
  Allocations() {
    const world::World floor = test::world("floor");
    maps_ = {test::map_at(floor, {8.6, 1.2, 0.1}, 0), test::map_at(floor, {9.1, 1.2, 0.4}, 1)};
    task_ = test::task_between(maps_[0], maps_[1], {0.6, 0.05, 0.25}, 0.4, 0.3);
  }
  const std::vector<FitnessForm> forms_ = fitness_forms();
  std::vector<topomap::LocalMap> maps_;
  MatchTask task_;
};

TEST_F(Allocations, AWarmSearchHasNone) {
  const Reference reference = make_reference(extract_features(maps_[0]));
  const MatchFeatures query = extract_features(maps_[1]);
  FitnessForms forms;
  BranchHypotheses hypotheses;
  GeneticSearch search;
  const auto run = [&] {
    forms.bind(reference, query, task_);
    return search.run(task_, forms.chosen(), hypotheses.find(task_, *reference.features, query));
  };
  for (const FitnessForm form : forms_) {
    task_.fitness_form = form;
    run();
  }
  const std::size_t before = allocations;
  std::uint32_t evaluations = 0;
  for (const FitnessForm form : forms_) {
    task_.fitness_form = form;
    for (task_.seed = 0; task_.seed < 20; ++task_.seed) evaluations += run();
  }
  EXPECT_EQ(allocations - before, 0U);
  EXPECT_EQ(evaluations, forms_.size() * 20U * (50U + 29U * 48U));
}

TEST_F(Allocations, AWarmMatchHasThoseOfItsResult) {
  Matcher matcher;
  for (const topomap::LocalMap& map : maps_) matcher.add_map(map);
  for (const FitnessForm form : forms_) {
    task_.fitness_form = form;
    matcher.solve(task_);
    const std::size_t before = allocations;
    const MatchResult result = matcher.solve(task_);
    EXPECT_EQ(result.solutions.size(), 3U);
    EXPECT_LE(allocations - before, 1U) << "the vector of solutions";
  }
}

TEST_F(Allocations, AFirstMatchHasSome) {
  Matcher matcher;
  for (const topomap::LocalMap& map : maps_) matcher.add_map(map);
  const std::size_t before = allocations;
  matcher.solve(task_);
  EXPECT_GT(allocations - before, 10U);
}

}  // namespace
}  // namespace topogeo::localization
