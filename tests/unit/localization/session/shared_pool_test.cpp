#include "shared_pool.hpp"

#include <set>

#include <gtest/gtest.h>

#include "topogeo/matching/matcher.hpp"

#include "localization/simulated_maps.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

/// Counts its maps.
class CountingPool : public InProcessPool {
 public:
  void add_map(std::shared_ptr<const topomap::LocalMap> map) override {
    ids.insert(map->id);
    ++added;
    InProcessPool::add_map(std::move(map));
  }
  std::vector<MatchResult> match(std::span<const MatchTask> given) override {
    for (const MatchTask& task : given) tasks.insert(task.task_id);
    return InProcessPool::match(given);
  }
  std::set<std::uint32_t> ids;
  std::set<std::uint64_t> tasks;
  std::size_t added = 0;
};

TEST(SharedPool, TwoMapsWithTheSameNumbersGetTheAnswersOfAPoolOfTheirOwn) {
  const world::World world = test::world("floor");
  const auto map_of = [&](double x_m, std::uint64_t session, std::uint32_t id) {
    topomap::LocalMap map = test::map_at(world, {x_m, 1.2, 0.0}, id);
    map.stop = {session, id};
    return std::make_shared<const topomap::LocalMap>(std::move(map));
  };
  CountingPool pool;
  SharedPool shared(pool);
  const auto west = shared.view();
  const auto east = shared.view();
  for (const auto& [view, x_m, session] : {std::tuple(west.get(), 2.0, std::uint64_t{1}),
                                           std::tuple(east.get(), 20.0, std::uint64_t{2})}) {
    const auto a = map_of(x_m, session, 0);
    const auto b = map_of(x_m + 0.6, session, 1);
    view->add_map(a);
    view->add_map(b);
    const MatchTask task = test::task_between(*a, *b, Pose2{0.5, 0.05, 0.0}, 0.2, 0.1);
    InProcessPool alone;
    alone.add_map(a);
    alone.add_map(b);
    const MatchResult expected = alone.match({&task, 1}).front();
    const MatchResult result = view->match({&task, 1}).front();
    EXPECT_EQ(result.task_id, task.task_id);
    EXPECT_EQ(result.T_reference_query, expected.T_reference_query);
    EXPECT_EQ(result.fitness, expected.fitness);
  }
  EXPECT_EQ(pool.ids.size(), 4U);
  EXPECT_EQ(pool.tasks.size(), 2U) << "no number twice";
  east->add_map(map_of(2.0, 1, 0));  // the same stop as its own stop 0
  EXPECT_EQ(pool.added, 4U) << "the stop is there already";
}

}  // namespace
}  // namespace topogeo::localization
