#include "topogeo/slam/match_requests.hpp"

#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/support/seed.hpp"

namespace topogeo::localization {
namespace {

using MapPointer = std::shared_ptr<const topomap::LocalMap>;

// Records its tasks and answers with the number of the task.
class RequestedPool : public MatchPool {
 public:
  void add_map(MapPointer map) override { maps.push_back(std::move(map)); }
  std::vector<MatchResult> match(std::span<const MatchTask> tasks) override {
    ++batches;
    std::vector<MatchResult> results;
    for (const MatchTask& task : tasks) {
      MatchResult& result = results.emplace_back();
      result.task_id = task.task_id;
      result.evaluations = 10;
      result.reason = task.task_id == 0 ? Reason::kNone : Reason::kDoubtful;
      if (!task.places) continue;
      place_tasks.push_back(task);
      result.solutions = {{{static_cast<double>(task.task_id), 0.0, 0.0}, 0.5}};
    }
    return results;
  }
  std::vector<MapPointer> maps;
  std::vector<MatchTask> place_tasks;
  int batches = 0;
};

MapPointer map_of(std::uint32_t id, const char* robot) {
  auto map = std::make_shared<topomap::LocalMap>();
  map->id = id;
  map->robot_id = robot;
  return map;
}

const UncertainPose kPredicted{{0.5, 0.1, 0.2}, Eigen::Vector3d(0.04, 0.01, 0.01).asDiagonal()};

TEST(MatchRequests, NamesMapsAndSeedsByRobotIdsAndNumber) {
  LocalizerConfig config;
  config.seed = 17;
  RequestedPool pool;
  MatchRequests requests(config, pool);
  const MapPointer reference = map_of(8, "one");
  const MapPointer query = map_of(3, "two");
  requests.add_map(reference);
  requests.add_map(query);
  EXPECT_EQ(pool.maps, (std::vector<MapPointer>{reference, query}));

  requests.number_from(40);
  const MatchTask task = requests.make(8, 3, kPredicted);
  EXPECT_EQ(task.task_id, 40U);
  EXPECT_EQ(task.reference_map_id, 8U);
  EXPECT_EQ(task.query_map_id, 3U);
  EXPECT_EQ(task.reference_hash, topomap::content_hash(*reference));
  EXPECT_EQ(task.query_hash, topomap::content_hash(*query));
  EXPECT_EQ(task.seed, support::derive_seed(17, "one", {8, 3, 40}));
  EXPECT_EQ(task.half_width, match_task(config, kPredicted).half_width);
  EXPECT_EQ(requests.make(8, 3, kPredicted).task_id, 41U);
  EXPECT_EQ(requests.next_task(), 42U);
}

TEST(MatchRequests, PartsOfASearchAreNumberedOnAndChangeNoSeed) {
  LocalizerConfig config;
  config.seed = 17;
  RequestedPool pool;
  MatchRequests requests(config, pool);
  requests.add_map(map_of(8, "one"));
  requests.add_map(map_of(3, "two"));
  const MatchTask before = requests.make(8, 3, kPredicted);
  const auto question = std::make_shared<const PlaceQuestion>();
  const std::vector<std::shared_ptr<const PlaceQuestion>> questions(3, question);
  const std::vector<MatchSolution> places = requests.ask(questions, 3);
  ASSERT_EQ(places.size(), 3U);
  EXPECT_EQ(places[2].T_reference_query.x_m, 3.0) << "by the number of its task";
  EXPECT_EQ(pool.place_tasks.size(), 3U);
  for (const MatchTask& task : pool.place_tasks) EXPECT_EQ(task.query_map_id, 3U);
  EXPECT_TRUE(requests.ask({}, 3).empty());
  EXPECT_EQ(pool.batches, 1);
  EXPECT_EQ(requests.counts().tasks, 0U);
  const MatchTask after = requests.make(8, 3, kPredicted);
  EXPECT_EQ(after.task_id, before.task_id + 4);
  EXPECT_EQ(after.seed, support::derive_seed(17, "one", {8, 3, 1}));
}

TEST(MatchRequests, CountsWhatComesBack) {
  RequestedPool pool;
  MatchRequests requests({}, pool);
  requests.add_map(map_of(0, "robot"));
  requests.add_map(map_of(1, "robot"));
  const std::vector<MatchTask> tasks{requests.make(1, 0, kPredicted),
                                     requests.make(1, 0, kPredicted)};
  const std::vector<MatchResult> results = requests.run(tasks);
  ASSERT_EQ(results.size(), 2U);
  EXPECT_EQ(results[1].task_id, 1U);
  EXPECT_EQ(requests.counts().tasks, 2U);
  EXPECT_EQ(requests.counts().evaluations, 20U);
  EXPECT_EQ(requests.counts().reasons[static_cast<std::size_t>(Reason::kNone)], 1U);
  EXPECT_EQ(requests.counts().reasons[static_cast<std::size_t>(Reason::kDoubtful)], 1U);
}

TEST(MatchRequests, NoTasksAskNothingOfThePool) {
  RequestedPool pool;
  MatchRequests requests({}, pool);
  EXPECT_TRUE(requests.run({}).empty());
  EXPECT_EQ(pool.batches, 0);
}

TEST(MatchRequests, RefusesAMapThatWasNotAdded) {
  RequestedPool pool;
  MatchRequests requests({}, pool);
  requests.add_map(map_of(0, "robot"));
  EXPECT_THROW(requests.make(0, 1, kPredicted), std::out_of_range);
  EXPECT_THROW(requests.make(1, 0, kPredicted), std::out_of_range);
  EXPECT_EQ(requests.next_task(), 0U);
}

}  // namespace
}  // namespace topogeo::localization
