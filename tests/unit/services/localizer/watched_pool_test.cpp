#include "localizer/watched_pool.hpp"

#include <memory>
#include <vector>

#include <gmock/gmock.h>

namespace topogeo::localizer {
namespace {

using localization::MatchResult;
using localization::MatchTask;

const StopsOfTasks kStopsOfTest = {{3, {11, 30}}, {4, {11, 40}}};

MatchTask match_task(std::uint32_t reference, std::uint32_t query) {
  MatchTask task;
  task.reference_map_id = reference;
  task.query_map_id = query;
  task.T_reference_query = {1.0, 2.0, 0.5};
  task.half_width = {0.6, 0.4, 0.2};
  task.covariance = Eigen::Vector3d(0.04, 0.01, 0.002).asDiagonal();
  return task;
}

TEST(WatchedPool, ShowsTheSpaceOfASearchAndWhatCameOfIt) {
  const std::vector<MatchTask> tasks = {match_task(3, 4), match_task(3, 99), match_task(4, 3)};

  msg::Search search = searched(tasks, kStopsOfTest);

  EXPECT_EQ(search.tasks(), 3U);
  EXPECT_TRUE(search.running());
  EXPECT_FALSE(search.whole_map());
  ASSERT_EQ(search.matches().size(), 2U);  // stop 99 is unknown
  EXPECT_EQ(search.matches()[0].base().number(), 30U);
  EXPECT_EQ(search.matches()[0].stop().number(), 40U);
  EXPECT_DOUBLE_EQ(search.matches()[0].half_width_x_m(), 0.6);
  EXPECT_DOUBLE_EQ(search.matches()[0].covariance()[4], 0.01);
  EXPECT_FALSE(search.matches()[0].done());

  std::vector<MatchResult> results(3);
  results[0].status = localization::MatchStatus::kSolved;
  results[0].verdict = localization::Verdict::kAccepted;
  results[0].reason = localization::Reason::kNone;
  results[0].T_reference_query = {1.1, 2.1, 0.4};
  results[0].fitness = 0.9;
  results[0].second = {{5.0, 5.0, 0.0}, 0.7};
  results[0].solutions = {{{1.05, 2.0, 0.4}, 0.8}};
  results[2].reason = localization::Reason::kNothingInCommon;
  add_results(tasks, results, kStopsOfTest, search);

  EXPECT_FALSE(search.running());
  EXPECT_TRUE(search.matches()[0].accepted());
  ASSERT_EQ(search.matches()[0].hypotheses().size(), 3U);
  EXPECT_DOUBLE_EQ(search.matches()[0].hypotheses()[0].T_base_robot().x_m(), 1.1);
  EXPECT_DOUBLE_EQ(search.matches()[0].hypotheses()[1].fitness(), 0.7);
  EXPECT_TRUE(search.matches()[1].done());
  EXPECT_FALSE(search.matches()[1].accepted());
  EXPECT_EQ(search.matches()[1].reason(), msg::kReasonNothingInCommon);
  EXPECT_TRUE(search.matches()[1].hypotheses().empty());
}

TEST(WatchedPool, ShowsTheBestPlacesOfAWholeMap) {
  std::vector<MatchTask> tasks(2);
  for (MatchTask& task : tasks) task.places = std::make_shared<localization::PlaceQuestion>();
  msg::Search search = searched(tasks, kStopsOfTest);
  EXPECT_TRUE(search.whole_map());
  EXPECT_TRUE(search.matches().empty());

  std::vector<MatchResult> results(2);
  for (double x_m = 0.0; x_m < 30.0; x_m += 1.0) {
    results[0].solutions.push_back({{x_m, 0.0, 0.0}, 0.01 * x_m});
    results[1].solutions.push_back({{x_m, 1.0, 0.0}, 0.005 + 0.01 * x_m});
  }
  add_results(tasks, results, kStopsOfTest, search);

  ASSERT_EQ(search.hypotheses().size(), msg::kMaxSearchHypotheses);
  EXPECT_DOUBLE_EQ(search.hypotheses()[0].T_base_robot().x_m(), 29.0);
  EXPECT_DOUBLE_EQ(search.hypotheses()[0].T_base_robot().y_m(), 1.0);
  EXPECT_DOUBLE_EQ(search.hypotheses()[1].T_base_robot().y_m(), 0.0);
}

TEST(WatchedPool, AMessageHasRoomForSoManyTasksAlone) {
  const std::vector<MatchTask> tasks(msg::kMaxSearchMatches + 5, match_task(3, 4));
  EXPECT_EQ(searched(tasks, kStopsOfTest).matches().size(), msg::kMaxSearchMatches);
}

}  // namespace
}  // namespace topogeo::localizer
