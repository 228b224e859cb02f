#include "topogeo/pipeline/loop_recall.hpp"

#include <stdexcept>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "localization/hand_scenes.hpp"

namespace topogeo::pipeline {
namespace {

using geometry::Pose2;
using storage::LoopCandidate;
using testing::ElementsAre;
using testing::Pair;

/// Thirty stops 3 m apart along a corridor, then five that come back beside stops 0 to 4:
///
///   30 at stop 0              revisit
///   31 1.9 m past stop 1      revisit of 1; stop 2 is 1.1 m away, but only 29 stops older
///   32 at stop 2, 0.9 rad     revisit
///   33 at stop 3, 1.1 rad     looks elsewhere
///   34 2.1 m beside stop 4    too far away
const std::vector<Pose2>& path() {
  static const std::vector<Pose2> kPath = [] {
    std::vector<Pose2> poses;
    poses.reserve(35);
    for (int i = 0; i < 30; ++i) poses.push_back({3.0 * i, 0.0, 0.0});
    poses.insert(poses.end(), {{0, 0, 0}, {4.9, 0, 0}, {6, 0, 0.9}, {9, 0, 1.1}, {12, 2.1, 0}});
    return poses;
  }();
  return kPath;
}

/// Local maps a second apart, with empty scans.
std::vector<topomap::LocalMap> maps_of(std::size_t count) {
  std::vector<topomap::LocalMap> maps(count);
  for (std::size_t i = 0; i < count; ++i) {
    maps[i].id = static_cast<std::uint32_t>(i);
    maps[i].stamp_ns = 1'000'000'000LL * static_cast<std::int64_t>(i);
  }
  return maps;
}

std::vector<topomap::StampedPose> reference_of(const std::vector<Pose2>& poses) {
  std::vector<topomap::StampedPose> reference;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    reference.push_back({i, 1'000'000'000LL * static_cast<std::int64_t>(i), poses[i]});
  }
  return reference;
}

LoopCandidate decision(std::uint32_t earlier, std::uint32_t later, const char* outcome,
                       const char* match = "accepted", const Pose2& T_off = {}) {
  LoopCandidate candidate;
  candidate.earlier_id = earlier;
  candidate.later_id = later;
  candidate.outcome = outcome;
  candidate.reason = match;
  candidate.source = "place";
  candidate.T_earlier_later = geometry::between(path()[earlier], path()[later]) * T_off;
  return candidate;
}

LoopRecall recall_of(const std::vector<LoopCandidate>& candidates) {
  return loop_recall(maps_of(path().size()), reference_of(path()), candidates);
}

TEST(LoopRecallTest, RevisitsAreThoseOfTheReference) {
  const LoopRecall recall = recall_of({});
  EXPECT_EQ(recall.stops, 35U);
  ASSERT_EQ(recall.revisits.size(), 3U);
  EXPECT_EQ(recall.revisits[0].stop, 30U);
  EXPECT_EQ(recall.revisits[1].stop, 31U);
  EXPECT_EQ(recall.revisits[2].stop, 32U);
  EXPECT_EQ(recall.tried(), 0U);
  EXPECT_EQ(recall.accepted(), 0U);
  EXPECT_EQ(recall.wrong(), 0U);
  EXPECT_TRUE(recall.rejected().empty());
}

TEST(LoopRecallTest, ARevisitIsTriedWithOneComparisonAndAcceptedWithOneLoop) {
  const LoopRecall recall =
      recall_of({decision(0, 30, "match not accepted", "few inliers"), decision(0, 30, "accepted"),
                 decision(1, 31, "match not accepted", "few inliers"),
                 decision(9, 32, "unconfirmed")});  // elsewhere
  EXPECT_EQ(recall.tried(), 2U);
  EXPECT_EQ(recall.accepted(), 1U);
  EXPECT_TRUE(recall.revisits[0].accepted);
  EXPECT_TRUE(recall.revisits[1].tried);
  EXPECT_FALSE(recall.revisits[2].tried);
}

TEST(LoopRecallTest, ALoopThatWasOutvotedIsNone) {
  const Pose2 far_off{5.0, 0.0, 0.0};
  const LoopRecall recall =
      recall_of({decision(0, 30, "accepted", "accepted", far_off),
                 decision(0, 30, "outvoted", "accepted", far_off), decision(1, 31, "accepted"),
                 decision(1, 31, "outvoted"), decision(1, 31, "accepted")});
  EXPECT_EQ(recall.tried(), 2U);
  EXPECT_EQ(recall.accepted(), 1U);
  EXPECT_TRUE(recall.revisits[1].accepted);
  EXPECT_EQ(recall.wrong(), 0U);
}

TEST(LoopRecallTest, DecisionsAreCountedBySourceOutcomeAndOffset) {
  std::vector<LoopCandidate> candidates{
      decision(0, 30, "match not accepted", "few inliers", {0.2, 0.0, 0.08}),
      decision(0, 30, "match not accepted", "few inliers", {0.3, 0.0, 0.0}),
      decision(0, 30, "match not accepted", "few inliers", {0.0, 0.0, 0.1}),
      decision(0, 30, "match not accepted", "few inliers", {0.0, 0.7, 0.0}),
      decision(1, 31, "unconfirmed"),
      decision(1, 31, "accepted", "accepted", {0.5, 0.0, 0.0}),
      decision(2, 32, "unconfirmed")};
  candidates.back().source = "window";
  const LoopRecall recall = recall_of(candidates);
  EXPECT_THAT(recall.outcomes,
              ElementsAre(LoopOutcomeCounts{"place", "accepted", 0, 1, 0},
                          LoopOutcomeCounts{"place", "match not accepted: few inliers", 1, 2, 1},
                          LoopOutcomeCounts{"place", "unconfirmed", 1, 0, 0},
                          LoopOutcomeCounts{"window", "unconfirmed", 1, 0, 0}));
  EXPECT_THAT(recall.rejected(),
              ElementsAre(Pair("match not accepted: few inliers", 1), Pair("unconfirmed", 2)));
}

TEST(LoopRecallTest, ProbabilitiesOfAllMatchesAreComparedWithTheReference) {
  std::vector<LoopCandidate> candidates{
      decision(0, 30, "match not accepted", "doubtful", {0.4, 0.0, 0.17}),  // right
      decision(0, 30, "match not accepted", "doubtful", {0.6, 0.0, 0.0}),
      decision(1, 31, "accepted", "accepted", {0.0, 0.0, 0.18}),
      decision(2, 32, "accepted"),  // right
      decision(2, 32, "match not accepted", "nothing in common")};
  for (LoopCandidate& candidate : candidates) candidate.probability = 0.75;
  candidates[2].probability = 0.25;
  const Reliability reliability = recall_of(candidates).reliability;
  EXPECT_EQ(reliability.count(), 4U);
  EXPECT_EQ(reliability.tenths()[7].count, 3U);
  EXPECT_EQ(reliability.tenths()[7].right, 2U);
  EXPECT_EQ(reliability.tenths()[2].count, 1U);
  EXPECT_EQ(reliability.tenths()[2].right, 0U);
}

TEST(LoopRecallTest, ALoopOffTheReferenceIsWrongUnlessTheScansFitBetter) {
  namespace scenes = localization::test;
  // Stops 0 and 30 are in one room, half a metre apart. The reference is right in the first case;
  // in the second it puts stop 30 1.5 m away from the true place.
  const Pose2 T_matched{0.5, 0.0, 0.0};
  const Pose2 T_other{0.5, 1.5, 0.0};
  std::vector<topomap::LocalMap> maps = maps_of(31);
  maps[0].points = scenes::exact_points(scenes::l_room(), {0.0, 0.0, 0.0});
  maps[30].points = scenes::exact_points(scenes::l_room(), T_matched);
  std::vector<Pose2> poses(path().begin(), path().begin() + 31);
  LoopCandidate loop = decision(0, 30, "accepted");

  poses[30] = T_matched;
  loop.T_earlier_later = T_other;
  const LoopRecall by_right_reference = loop_recall(maps, reference_of(poses), std::vector{loop});
  ASSERT_EQ(by_right_reference.off_reference.size(), 1U);
  EXPECT_NEAR(by_right_reference.off_reference[0].off_m, 1.5, 1e-12);
  EXPECT_EQ(by_right_reference.wrong(), 1U);

  poses[30] = T_other;
  loop.T_earlier_later = T_matched;
  const LoopRecall by_wrong_reference = loop_recall(maps, reference_of(poses), std::vector{loop});
  ASSERT_EQ(by_wrong_reference.off_reference.size(), 1U);
  EXPECT_GT(by_wrong_reference.off_reference[0].in_common, 0.9);
  EXPECT_EQ(by_wrong_reference.wrong(), 0U);
}

// A wall beside stops 0 and 30, and another one elsewhere for stop 31, at the place of stop 1.
TEST(LoopRecallTest, ARevisitIsInViewWhenHalfOfItsPointsAreThereForTheOlderStop) {
  std::vector<topomap::LocalMap> maps = maps_of(path().size());
  for (int i = 0; i < 40; ++i) {
    const float x_m = -1.0F + 0.05F * static_cast<float>(i);
    for (const std::size_t stop : {0U, 30U, 1U}) maps[stop].points.push_back({x_m, 1.0F});
    maps[31].points.push_back({x_m, -2.0F});
  }
  const LoopRecall recall =
      loop_recall(maps, reference_of(path()), std::vector{decision(0, 30, "accepted")});
  EXPECT_TRUE(recall.revisits[0].in_view);
  EXPECT_FALSE(recall.revisits[1].in_view);
  EXPECT_EQ(recall.in_view(), 1U);
  EXPECT_EQ(recall.accepted_in_view(), 1U);
}

TEST(LoopRecallTest, StopsWithoutAReferencePoseDoNotCount) {
  std::vector<topomap::StampedPose> reference = reference_of(path());
  reference.erase(reference.begin() + 30);   // the first revisit
  reference.back().stamp_ns += 100'000'000;  // too late for its stop
  const LoopRecall recall =
      loop_recall(maps_of(path().size()), reference, std::vector{decision(0, 30, "unconfirmed")});
  EXPECT_EQ(recall.stops, 33U);
  EXPECT_EQ(recall.revisits.size(), 2U);
  EXPECT_TRUE(recall.outcomes.empty());
}

TEST(LoopRecallTest, AReportOrReferenceOfAnotherMapIsRefused) {
  const auto maps = maps_of(31);
  EXPECT_THROW(loop_recall(maps, reference_of(path()), std::vector{decision(0, 31, "accepted")}),
               std::invalid_argument);
  EXPECT_THROW(loop_recall(maps, {}, {}), std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::pipeline
