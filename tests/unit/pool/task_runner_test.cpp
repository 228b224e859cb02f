#include "task_runner.hpp"

#include <condition_variable>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/geometry/portable_math.hpp"

#include "task_board.hpp"

namespace topogeo::ga_worker {
namespace {

using localization::MatchTask;
using Failure = TaskRunner::Failure;
using std::chrono::milliseconds;
using MapPointer = std::shared_ptr<const topomap::LocalMap>;

/// Nothing that works takes so long.
constexpr std::chrono::seconds kPatience{20};

/// The robot in a room of 6 m by 4 m with a pillar, `shift_m` to the right of its middle.
MapPointer room(std::uint32_t id, double shift_m, const std::string& robot_id = "robot") {
  topomap::LocalMap map;
  map.robot_id = robot_id;
  map.id = id;
  for (int i = 0; i < 180; ++i) {
    const auto direction =
        geometry::sincos(std::numbers::pi * (static_cast<double>(i) / 180.0 - 0.5));
    const double to_front_m = (3.0 - shift_m) / direction.cos;
    const double to_side_m = 2.0 / std::max(1e-9, std::abs(direction.sin));
    const double range_m = i > 80 && i < 95 ? 1.5 - shift_m : std::min(to_front_m, to_side_m);
    map.points.push_back(
        {static_cast<float>(range_m * direction.cos), static_cast<float>(range_m * direction.sin)});
  }
  return std::make_shared<const topomap::LocalMap>(std::move(map));
}

MatchTask task(const topomap::LocalMap& reference, const topomap::LocalMap& query,
               std::uint64_t id) {
  MatchTask result;
  result.task_id = id;
  result.reference_map_id = reference.id;
  result.query_map_id = query.id;
  result.reference_hash = topomap::content_hash(reference);
  result.query_hash = topomap::content_hash(query);
  result.T_reference_query = {0.1, 0.0, 0.0};
  result.covariance = Eigen::Vector3d(0.04, 0.04, 0.01).asDiagonal();
  result.half_width = Eigen::Vector3d(0.5, 0.5, 0.3);
  result.seed = id + 1;
  return result;
}

class TaskRunnerTest : public ::testing::Test {
 protected:
  void start(std::size_t slots, std::chrono::nanoseconds map_patience) {
    runner_ = std::make_unique<TaskRunner>(slots, map_patience, [this](TaskRunner::Outcome o) {
      const std::lock_guard lock(mutex_);
      outcomes_.emplace(o.ticket, std::move(o));
      came_.notify_all();
    });
  }
  bool wait_for(std::size_t count) {
    std::unique_lock lock(mutex_);
    return came_.wait_for(lock, kPatience, [&] { return outcomes_.size() >= count; });
  }

  std::mutex mutex_;
  std::condition_variable came_;
  std::map<std::uint64_t, TaskRunner::Outcome> outcomes_;
  std::vector<MapPointer> maps_{room(0, 0.0), room(1, 0.2), room(2, 0.4)};
  std::unique_ptr<TaskRunner> runner_;  // last: stops before what its threads use goes
};

TEST_F(TaskRunnerTest, SeveralSlotsGiveWhatOneMatcherGives) {
  start(3, kPatience);
  localization::Matcher matcher;
  for (const MapPointer& map : maps_) {
    matcher.add_map(*map);
    runner_->add_map(map);
  }
  std::vector<MatchTask> tasks;
  for (std::uint64_t i = 0; i < 40; ++i) {
    tasks.push_back(task(*maps_[i % 2], *maps_[1 + i % 2], i));
    runner_->add({1000 + i, "robot", tasks.back()});
  }
  ASSERT_TRUE(wait_for(40));
  for (const MatchTask& t : tasks) {
    const TaskRunner::Outcome& outcome = outcomes_.at(1000 + t.task_id);
    EXPECT_EQ(outcome.failure, Failure::kNone) << outcome.message;
    EXPECT_TRUE(localizer::identical(outcome.result, matcher.solve(t))) << t.task_id;
    EXPECT_EQ(outcome.result.status, localization::MatchStatus::kSolved);
  }
  EXPECT_EQ(runner_->in_hand(), 0U);
  EXPECT_EQ(runner_->maps_held(), 3U);
  EXPECT_GT(runner_->busy_time().count(), 0);
}

TEST_F(TaskRunnerTest, ATaskWaitsForItsMapsAndOthersPassIt) {
  start(1, kPatience);
  runner_->add_map(maps_[0]);
  runner_->add_map(maps_[1]);
  runner_->add({1, "robot", task(*maps_[0], *maps_[2], 1)});
  runner_->add({2, "robot", task(*maps_[0], *maps_[1], 2)});
  ASSERT_TRUE(wait_for(1));
  EXPECT_TRUE(outcomes_.contains(2));
  EXPECT_EQ(runner_->in_hand(), 1U);
  runner_->add_map(maps_[2]);
  ASSERT_TRUE(wait_for(2));
  EXPECT_EQ(outcomes_.at(1).failure, Failure::kNone);
}

TEST_F(TaskRunnerTest, MapsThatDoNotComeAreSaidToBeMissing) {
  start(2, milliseconds(20));
  runner_->add_map(maps_[0]);
  runner_->add({1, "robot", task(*maps_[0], *maps_[1], 1)});
  ASSERT_TRUE(wait_for(1));
  EXPECT_EQ(outcomes_.at(1).failure, Failure::kMapMissing);
  EXPECT_THAT(outcomes_.at(1).message, ::testing::HasSubstr("map 0 or 1"));
}

TEST_F(TaskRunnerTest, AMapOfAnotherRobotOrOtherContentIsNotTheOneThatIsMeant) {
  start(1, milliseconds(20));
  runner_->add_map(maps_[0]);
  runner_->add_map(room(1, 0.2, "another"));
  runner_->add({1, "robot", task(*maps_[0], *maps_[1], 1)});
  ASSERT_TRUE(wait_for(1));
  EXPECT_EQ(outcomes_.at(1).failure, Failure::kMapMissing);
  runner_->add_map(room(1, 0.3));
  runner_->add({2, "robot", task(*maps_[0], *maps_[1], 2)});
  ASSERT_TRUE(wait_for(2));
  EXPECT_EQ(outcomes_.at(2).failure, Failure::kMapMissing);
}

TEST_F(TaskRunnerTest, ANewMapOfAnIdReplacesTheOldOneInEverySlot) {
  start(1, kPatience);
  runner_->add_map(maps_[0]);
  runner_->add_map(maps_[1]);
  runner_->add({1, "robot", task(*maps_[0], *maps_[1], 1)});
  ASSERT_TRUE(wait_for(1));
  const MapPointer changed = room(1, 0.3);
  runner_->add_map(changed);
  const MatchTask again = task(*maps_[0], *changed, 2);
  runner_->add({2, "robot", again});
  ASSERT_TRUE(wait_for(2));
  localization::Matcher matcher;
  matcher.add_map(*maps_[0]);
  matcher.add_map(*changed);
  EXPECT_TRUE(localizer::identical(outcomes_.at(2).result, matcher.solve(again)));
}

TEST_F(TaskRunnerTest, ATaskThatCannotBeSolvedSaysWhyAndTheSlotLivesOn) {
  start(1, kPatience);
  runner_->add_map(maps_[0]);
  runner_->add_map(maps_[1]);
  MatchTask bad = task(*maps_[0], *maps_[1], 1);
  bad.half_width.setZero();
  runner_->add({1, "robot", bad});
  runner_->add({2, "robot", task(*maps_[0], *maps_[1], 2)});
  ASSERT_TRUE(wait_for(2));
  EXPECT_EQ(outcomes_.at(1).failure, Failure::kFailed);
  EXPECT_THAT(outcomes_.at(1).message, ::testing::HasSubstr("search space is empty"));
  EXPECT_EQ(outcomes_.at(2).failure, Failure::kNone);
}

TEST_F(TaskRunnerTest, ItEndsWithTasksInHand) {
  start(2, kPatience);
  runner_->add_map(maps_[0]);
  runner_->add_map(maps_[1]);
  for (std::uint64_t i = 0; i < 50; ++i) {
    runner_->add({i, "robot", task(*maps_[0], *maps_[i % 3], i)});
  }
  runner_.reset();
  EXPECT_LE(outcomes_.size(), 50U);
}

TEST(TaskRunner, NeedsASlot) {
  EXPECT_THROW(TaskRunner(0, kPatience, [](const auto&) {}), std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::ga_worker
