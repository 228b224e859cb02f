#include "map_store/map_input.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "topogeo/messaging/message.hpp"
#include "topogeo/service/conversions.hpp"

#include "services/common/random_values.hpp"

namespace topogeo::map_store {
namespace {

using Arrival = MapInput::Arrival;

constexpr std::uint64_t kSession = 11;
constexpr std::uint64_t kOther = 5;  // later, though its number is smaller

class Input : public testing::Test {
 protected:
  Input() {
    for (std::uint32_t i = 0; i < 3; ++i) {
      maps_.push_back(any_local_map(random_));
      maps_.back().id = i;
      maps_.back().stop = {kSession, i};
    }
    trajectory_ = any_trajectory(random_, 3);
    trajectory_.version = 8;
    for (topomap::StopPose& stop : trajectory_.stops) stop.stop = {kSession, stop.local_map_id};
    end_.count(3);
    end_.version(8);
  }
  [[nodiscard]] msg::LoopClosures closures(std::uint64_t version) const {
    const std::vector<topomap::LoopClosure> list = {{0, 1, {}}, {0, 2, {}}};
    return service::to_msg(list, version, "robot", 0, 0);
  }

  [[nodiscard]] static msg::MapEdges edges(std::uint64_t version) {
    std::vector<storage::MapEdge> list(2);
    for (std::uint32_t i = 0; i < 2; ++i) {
      list[i].earlier_id = i;
      list[i].later_id = i + 1;
    }
    return service::to_segment(list, 0, version, "robot", 0, 0);
  }

  support::Random random_{1};
  std::vector<topomap::LocalMap> maps_;
  topomap::Trajectory trajectory_;
  msg::StreamEnd end_;
  MapInput input_;
};

TEST_F(Input, LocalMapsWaitForTheOnesBefore) {
  input_.add(service::to_segment(trajectory_, 0, "robot", 0));
  EXPECT_EQ(input_.add(maps_[2]), Arrival::kNew);
  EXPECT_EQ(input_.add(maps_[1]), Arrival::kNew);
  EXPECT_TRUE(input_.local_maps().empty());
  EXPECT_EQ(input_.waiting(), 2U);
  EXPECT_EQ(input_.add(maps_[0]), Arrival::kNew);
  EXPECT_TRUE(input_.local_maps() == maps_);
  EXPECT_EQ(input_.waiting(), 0U);
}

TEST_F(Input, SecondMapOfAnIdIsKnownOrDifferent) {
  input_.add(maps_[0]);
  input_.add(maps_[2]);
  EXPECT_EQ(input_.add(maps_[0]), Arrival::kKnown);
  EXPECT_EQ(input_.add(maps_[2]), Arrival::kKnown);
  topomap::LocalMap other = maps_[0];
  other.points[0].x_m += 1.0F;
  EXPECT_EQ(input_.add(other), Arrival::kDifferent);
  input_.add(service::to_segment(trajectory_, 0, "robot", 0));
  EXPECT_TRUE(input_.local_maps()[0] == maps_[0]);
}

TEST_F(Input, TakesInWhatTheTrajectoryNamesAndNumbersItAsThatDoes) {
  trajectory_.stops.resize(2);
  trajectory_.stops[1].stop = {kSession, 2};  // the stop in between is in no map
  for (const auto& map : maps_) input_.add(map);
  EXPECT_TRUE(input_.local_maps().empty());
  input_.add(service::to_segment(trajectory_, 0, "robot", 0));
  ASSERT_EQ(input_.local_maps().size(), 2U);
  EXPECT_TRUE(input_.local_maps()[1] == topomap::numbered(maps_[2], 1, true));
  // The one in between is never used again, however often it arrives.
  EXPECT_EQ(input_.waiting(), 0U);
  EXPECT_EQ(input_.add(maps_[1]), Arrival::kKnown);
  EXPECT_EQ(input_.waiting(), 0U);
  EXPECT_EQ(input_.dropped(), 1U);
  EXPECT_FALSE(input_.lost());
}

// A robot that is followed in its map for days makes stops that do not join it.
TEST_F(Input, SoManyMapsWaitAndNoMore) {
  const auto most = static_cast<std::uint32_t>(MapInput::kMostWaiting);
  topomap::LocalMap map = maps_[0];
  for (map.stop.number = 0; map.stop.number < most + 2; ++map.stop.number) {
    EXPECT_EQ(input_.add(map), Arrival::kNew);
  }
  EXPECT_EQ(input_.waiting(), most);
  EXPECT_EQ(input_.dropped(), 2U);
  // Later ones join the map.
  trajectory_.stops.resize(1);
  trajectory_.stops[0].stop = {kSession, most + 1};
  input_.add(service::to_segment(trajectory_, 0, "robot", 0));
  EXPECT_EQ(input_.local_maps().size(), 1U);
  EXPECT_EQ(input_.waiting(), 0U);
  EXPECT_EQ(input_.dropped(), most + 1U);
  EXPECT_FALSE(input_.lost());
}

TEST_F(Input, ADroppedMapThatTheTrajectoryNamesIsLost) {
  const auto most = static_cast<std::uint32_t>(MapInput::kMostWaiting);
  topomap::LocalMap map = maps_[0];
  for (map.stop.number = 0; map.stop.number < most + 2; ++map.stop.number) input_.add(map);
  trajectory_.stops.resize(1);
  trajectory_.stops[0].stop = {kSession, 1};
  input_.add(service::to_segment(trajectory_, 0, "robot", 0));
  EXPECT_TRUE(input_.local_maps().empty());
  EXPECT_EQ(input_.lost(), (topomap::StopId{kSession, 1}));
}

TEST_F(Input, ExtendsAStoredMap) {
  input_ = MapInput(MapInput::Stored{.local_maps = {maps_[0], maps_[1]}});
  trajectory_.stops[0].stop = {kSession, 0};
  trajectory_.stops[1].stop = {kSession, 1};
  trajectory_.stops[2].stop = {kOther, 0};
  maps_[2].stop = {kOther, 0};
  input_.add(maps_[2]);
  EXPECT_EQ(input_.local_maps().size(), 2U);
  input_.add(service::to_segment(trajectory_, 0, "robot", 0));
  ASSERT_EQ(input_.local_maps().size(), 3U);
  EXPECT_TRUE(input_.local_maps()[2] == topomap::numbered(maps_[2], 2, true));
}

TEST_F(Input, RefusesATrajectoryOfAnotherStoredMap) {
  trajectory_.stops[1].stop = {kOther, 1};
  const msg::TrajectorySegment segment = service::to_segment(trajectory_, 0, "robot", 0);
  input_ = MapInput(MapInput::Stored{.local_maps = {maps_[0], maps_[1]}});
  EXPECT_THROW(input_.add(segment), std::invalid_argument);
}

/// The stored map without its second stop, and another drive that joins it.
class RenewedInput : public Input {
 protected:
  RenewedInput() {
    input_ = MapInput(MapInput::Stored{.local_maps = maps_, .trajectory = trajectory_});
    joins_ = maps_[1];
    joins_.stop = {kOther, 0};
    trajectory_.version = trajectory_.numbered_since = 20;
    trajectory_.stops[1].stop = {kSession, 2};
    trajectory_.stops[2].stop = joins_.stop;
  }

  /// A renumbered trajectory, too; its first stop is the last stored one, the others are from the
  /// other drive.
  topomap::Trajectory of_two_segments() {
    topomap::Trajectory large = any_trajectory(random_, msg::kSegmentStops + 2);
    large.version = large.numbered_since = 20;
    for (topomap::StopPose& stop : large.stops) stop.stop = {kOther, stop.local_map_id};
    large.stops[0].stop = maps_[2].stop;
    return large;
  }

  topomap::LocalMap joins_;
};

TEST_F(RenewedInput, StopsThatTheTrajectoryHasNoMoreLeaveTheMap) {
  input_.add(joins_);
  input_.add(service::to_msg(std::vector<topomap::LoopClosure>{{0, 1, {}}}, 20, "robot", 0, 0, 20));
  EXPECT_EQ(input_.local_maps().size(), 3U);
  input_.add(service::to_segment(trajectory_, 0, "robot", 0));
  ASSERT_EQ(input_.local_maps().size(), 3U);
  EXPECT_TRUE(input_.local_maps()[0] == maps_[0]);
  EXPECT_TRUE(input_.local_maps()[1] == topomap::numbered(maps_[2], 1, true));
  EXPECT_TRUE(input_.local_maps()[2] == topomap::numbered(joins_, 2, true));
  EXPECT_EQ(input_.numbered_since(), 20U);
  EXPECT_EQ(input_.usable_closures().size(), 1U);
  EXPECT_EQ(input_.add(maps_[1]), Arrival::kKnown) << "it is not taken in again";
  EXPECT_EQ(input_.waiting(), 0U);
  EXPECT_TRUE(input_.newest_trajectory() == trajectory_);
}

TEST_F(RenewedInput, TheStopsThatJoinMayComeLater) {
  input_.add(service::to_segment(trajectory_, 0, "robot", 0));
  EXPECT_EQ(input_.local_maps().size(), 2U);
  input_.add(joins_);
  EXPECT_EQ(input_.local_maps().size(), 3U);
}

TEST_F(RenewedInput, WhatHasTheNumbersOfBeforeIsPassedOver) {
  topomap::Trajectory before = trajectory_;
  before.numbered_since = 0;
  before.version = 30;
  before.stops[1].stop = {kSession, 1};
  input_.add(joins_);
  input_.add(service::to_segment(trajectory_, 0, "robot", 0));
  input_.add(service::to_segment(before, 0, "robot", 0));
  input_.add(service::to_msg(std::vector<topomap::LoopClosure>{{0, 1, {}}}, 30, "robot", 0, 0, 0));
  EXPECT_TRUE(input_.newest_trajectory() == trajectory_);
  EXPECT_TRUE(input_.usable_closures().empty());
}

TEST_F(RenewedInput, TakesEffectWhenAllOfItHasCome) {
  const topomap::Trajectory large = of_two_segments();
  input_.add(service::to_segment(large, 1, "robot", 0));
  EXPECT_EQ(input_.numbered_since(), 0U);
  EXPECT_EQ(input_.local_maps().size(), 3U);
  input_.add(service::to_segment(large, 0, "robot", 0));
  EXPECT_EQ(input_.numbered_since(), 20U);
  ASSERT_EQ(input_.local_maps().size(), 1U);
  EXPECT_EQ(input_.local_maps()[0].stop, maps_[2].stop);
}

TEST_F(RenewedInput, NeitherBeginsNorEndsWithAMessageThatIsRefused) {
  const topomap::Trajectory large = of_two_segments();
  input_.add(service::to_segment(large, 1, "robot", 0));

  const double not_a_number = std::numeric_limits<double>::quiet_NaN();
  msg::TrajectorySegment segment = service::to_segment(large, 1, "robot", 0);
  segment.stops().front().T_map_robot().x_m(not_a_number);
  segment.numbered_since(30);
  EXPECT_THROW(input_.add(segment), std::invalid_argument);
  segment.numbered_since(0);
  segment.version(30);
  EXPECT_THROW(input_.add(segment), std::invalid_argument);
  msg::LoopClosures closures =
      service::to_msg(std::vector<topomap::LoopClosure>{{0, 1, {}}}, 30, "robot", 0, 0, 30);
  closures.closures().front().T_earlier_later().x_m(not_a_number);
  EXPECT_THROW(input_.add(closures), std::invalid_argument);
  msg::MapEdges refused_edges = edges(30);
  refused_edges.numbered_since(30);
  refused_edges.edges().front().T_earlier_later().x_m(not_a_number);
  EXPECT_THROW(input_.add(refused_edges), std::invalid_argument);

  input_.add(service::to_segment(large, 0, "robot", 0));
  EXPECT_EQ(input_.numbered_since(), 20U);
}

TEST_F(RenewedInput, NothingLeavesBecauseOfAStopThatIsLate) {
  trajectory_.stops[1].stop = joins_.stop;
  trajectory_.stops[2].stop = {kSession, 2};
  input_.add(service::to_segment(trajectory_, 0, "robot", 0));
  EXPECT_TRUE(input_.local_maps() == maps_);
  input_.add(joins_);
  ASSERT_EQ(input_.local_maps().size(), 3U);
  EXPECT_EQ(input_.local_maps()[1].stop, joins_.stop);
  EXPECT_EQ(input_.local_maps()[2].stop, (topomap::StopId{kSession, 2}));
}

TEST_F(RenewedInput, RefusesOneOfAnotherMap) {
  trajectory_.stops[0].stop = {kOther, 7};
  const msg::TrajectorySegment segment = service::to_segment(trajectory_, 0, "robot", 0);
  EXPECT_THROW(input_.add(segment), std::invalid_argument);
  EXPECT_TRUE(input_.local_maps() == maps_);
}

TEST_F(Input, TrajectoryReachesAsFarAsTheLocalMaps) {
  input_.add(service::to_segment(trajectory_, 0, "robot", 0));
  input_.add(closures(8));
  EXPECT_TRUE(input_.newest_trajectory().stops.empty());
  input_.add(maps_[0]);
  input_.add(maps_[1]);
  EXPECT_EQ(input_.newest_trajectory().stops.size(), 2U);
  EXPECT_EQ(input_.usable_closures().size(), 1U);
}

TEST_F(Input, EdgesChangeWithTheirMessagesAndWithTheLocalMapsTheyWaitFor) {
  input_.add(service::to_segment(trajectory_, 0, "robot", 0));
  input_.add(maps_[0]);
  input_.add(maps_[1]);
  const std::uint64_t with_two_maps = input_.edge_changes();
  input_.add(edges(8));
  EXPECT_EQ(input_.usable_edges().size(), 1U);
  const std::uint64_t with_edges = input_.edge_changes();
  EXPECT_GT(with_edges, with_two_maps);
  input_.add(maps_[2]);
  EXPECT_EQ(input_.usable_edges().size(), 2U);
  EXPECT_GT(input_.edge_changes(), with_edges);
}

TEST_F(Input, CompleteOnlyWithEveryPartOfTheFinalVersion) {
  using Step = std::function<void()>;
  const std::vector<Step> steps = {
      [&] { input_.add(maps_[0]); },
      [&] { input_.add(maps_[1]); },
      [&] { input_.add(maps_[2]); },
      [&] { input_.add(service::to_segment(trajectory_, 0, "robot", 0)); },
      [&] { input_.add(closures(8)); },
      [&] { input_.add(edges(8)); },
      [&] { input_.set_end(end_); },
  };
  for (std::size_t last = 0; last < steps.size(); ++last) {
    input_ = MapInput();
    for (std::size_t i = 0; i < steps.size(); ++i) {
      if (i != last) steps[i]();
    }
    EXPECT_FALSE(input_.final_trajectory().has_value()) << "without step " << last;
    steps[last]();
    ASSERT_TRUE(input_.final_trajectory().has_value()) << "step " << last << " last";
    EXPECT_TRUE(*input_.final_trajectory() == trajectory_);
  }
}

TEST_F(Input, OlderPartsDoNotCompleteIt) {
  for (const auto& map : maps_) input_.add(map);
  input_.set_end(end_);
  input_.add(closures(7));
  input_.add(service::to_segment(trajectory_, 0, "robot", 0));
  EXPECT_FALSE(input_.final_trajectory().has_value());
  input_.add(closures(8));
  input_.add(closures(7));  // late: ignored
  EXPECT_FALSE(input_.final_trajectory().has_value());
  input_.add(edges(8));
  input_.add(edges(7));
  EXPECT_TRUE(input_.final_trajectory().has_value());
}

}  // namespace
}  // namespace topogeo::map_store
