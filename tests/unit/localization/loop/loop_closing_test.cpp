// A corridor driven along x and back: stops 0 to 5 out, 6 to 11 back over the same places. Odometry
// drifts sideways, so the stops back lie beside those out.
#include "loop/loop_closing.hpp"

#include <numeric>
#include <vector>

#include <gtest/gtest.h>

namespace topogeo::localization {
namespace {

using geometry::Pose2;
using LoopVerdict = LoopClosing::Verdict;

Eigen::Matrix3d spread(double sigma_m, double sigma_rad) {
  return Eigen::Vector3d(sigma_m * sigma_m, sigma_m * sigma_m, sigma_rad * sigma_rad).asDiagonal();
}

/// Straight stops 1 m apart, each known to 0.2 m from the previous one.
PoseGraph straight(std::uint32_t stops) {
  PoseGraph graph;
  graph.add_pose({});
  for (std::uint32_t i = 1; i < stops; ++i) {
    graph.add_pose({1.0 * i, 0.0, 0.0});
    graph.add_edge({i - 1, i, EdgeKind::kOdometry, {1.0, 0.0, 0.0}, spread(0.2, 0.05)});
  }
  return graph;
}

/// A match that puts stop `to` `off_m` to the side of its place.
StopMatch loop(std::uint32_t from, std::uint32_t to, double off_m, double fitness = 0.9) {
  StopMatch match;
  match.edge = {from, to, EdgeKind::kRevisit, {1.0 * (to - from), off_m, 0.0}, spread(0.02, 0.005)};
  match.verdict = Verdict::kAccepted;
  match.reason = Reason::kNone;
  match.fitness = fitness;
  return match;
}

/// The same with the robot expected on its straight path with this deviation.
StopMatch predicted(StopMatch match, double sigma_m) {
  match.predicted = {{1.0 * (match.edge.to - match.edge.from), 0.0, 0.0}, spread(sigma_m, 0.05)};
  return match;
}

/// Path to each stop of straight().
std::vector<double> path_to(std::uint32_t stops) {
  std::vector<double> path_m(stops);
  std::iota(path_m.begin(), path_m.end(), 0.0);
  return path_m;
}

StopMatch doubted(StopMatch match) {
  match.verdict = Verdict::kRejected;
  match.reason = Reason::kDoubtful;
  match.inliers = match.overlap = 1.0;
  return match;
}

TEST(LoopClosing, ASmallCorrectionIsAcceptedAtOnce) {
  const PoseGraph graph = straight(12);
  LoopClosing loops({});
  EXPECT_EQ(loops.judge_alone(graph, loop(0, 11, 0.05)), LoopVerdict::kAgrees);
  EXPECT_TRUE(loops.waiting().empty());  // adding it is up to the caller
  EXPECT_EQ(loops.judge_alone(graph, loop(1, 11, 0.3, 0.8)), LoopVerdict::kMoves);
  ASSERT_EQ(loops.waiting().size(), 1U);
  EXPECT_EQ(loops.waiting()[0].from, 1U);
  ASSERT_EQ(loops.decisions().size(), 2U);
  const LoopDecision& decision = loops.decisions()[1];
  EXPECT_EQ(decision.step, 11U);
  EXPECT_EQ(decision.earlier_id, 1U);
  EXPECT_EQ(decision.later_id, 11U);
  EXPECT_EQ(decision.outcome, LoopOutcome::kAccepted);
  EXPECT_NEAR(decision.correction_m, 0.3, 1e-12);
  EXPECT_NEAR(decision.correction_rad, 0.0, 1e-12);
  EXPECT_EQ(decision.fitness, 0.8);
  EXPECT_EQ(decision.evidence.kind, LoopEvidence::Kind::kPassed);
  EXPECT_EQ(decision.probability, loop_probability(decision.evidence));
}

TEST(LoopClosing, AFarCorrectionWaitsForAnotherStopThatAgrees) {
  const PoseGraph graph = straight(12);
  LoopClosing loops({});
  EXPECT_EQ(loops.judge_alone(graph, loop(0, 10, 1.0)), LoopVerdict::kPending);
  EXPECT_TRUE(loops.waiting().empty());
  EXPECT_EQ(loops.unconfirmed(), 1U);
  // The same stop again is no proof, nor is another one that moves the robot elsewhere.
  EXPECT_EQ(loops.judge_alone(graph, loop(1, 10, 1.0)), LoopVerdict::kPending);
  EXPECT_EQ(loops.judge_alone(graph, loop(1, 11, -1.0)), LoopVerdict::kPending);
  EXPECT_EQ(loops.judge_alone(graph, loop(2, 11, 1.1)), LoopVerdict::kMoves);
  ASSERT_EQ(loops.waiting().size(), 3U);  // including both loops of stop 10
  EXPECT_EQ(loops.waiting()[0].from, 0U);
  EXPECT_EQ(loops.waiting()[1].from, 1U);
  EXPECT_EQ(loops.waiting()[2].from, 2U);
  EXPECT_EQ(loops.decisions().back().outcome, LoopOutcome::kAccepted);
  EXPECT_EQ(loops.unconfirmed(), 3U);
}

TEST(LoopClosing, AWaitingLoopConfirmsAFarOne) {
  const PoseGraph graph = straight(12);
  LoopClosing loops({});
  loops.accept(graph, loop(0, 10, 1.0, 0.7));
  EXPECT_EQ(loops.judge_alone(graph, loop(1, 11, 1.0)), LoopVerdict::kMoves);
}

TEST(LoopClosing, APendingLoopIsDroppedInTheEnd) {
  const PoseGraph graph = straight(40);
  LoopClosing loops({});
  EXPECT_EQ(loops.judge_alone(graph, loop(0, 20, 1.0)), LoopVerdict::kPending);
  EXPECT_EQ(loops.judge_alone(graph, loop(0, 33, 1.0)), LoopVerdict::kPending);  // 13 stops later
  EXPECT_EQ(loops.judge_alone(graph, loop(0, 34, 1.0)), LoopVerdict::kMoves);
  EXPECT_EQ(loops.waiting().size(), 2U);
  LoopClosing dropped({});
  EXPECT_EQ(dropped.judge_alone(graph, loop(0, 20, 1.0)), LoopVerdict::kPending);
  dropped.drop_pending();
  EXPECT_EQ(dropped.judge_alone(graph, loop(0, 21, 1.0)), LoopVerdict::kPending);
}

TEST(LoopClosing, StepsThatCannotBeBentRefuseALoop) {
  const PoseGraph graph = straight(5);  // at stop 4 odometry is known to 0.4 m
  LoopClosing loops({});
  EXPECT_EQ(loops.judge_alone(graph, loop(0, 4, 6.0)), LoopVerdict::kRefused);
  ASSERT_EQ(loops.decisions().size(), 1U);
  EXPECT_EQ(loops.decisions()[0].outcome, LoopOutcome::kNoClosing);
  EXPECT_TRUE(loops.decisions()[0].evidence.contradicted);
  EXPECT_TRUE(loops.waiting().empty());
}

TEST(LoopClosing, AMatchFarFromItsPredictionNeedsOthersHoweverSmallTheCorrection) {
  const PoseGraph graph = straight(12);
  LoopClosing loops({});
  EXPECT_EQ(loops.judge_alone(graph, predicted(loop(0, 10, 0.5), 0.4)), LoopVerdict::kMoves);
  EXPECT_EQ(loops.judge_alone(graph, predicted(loop(0, 11, 0.5), 0.1)), LoopVerdict::kPending);
  EXPECT_EQ(loops.decisions().back().outcome, LoopOutcome::kUnconfirmed);
}

TEST(LoopClosing, ARoundReturnsTheEffectOfEachVerdict) {
  PoseGraph graph = straight(12);
  const std::size_t steps = graph.edges().size();
  LoopClosing loops({});
  const std::vector matches{loop(0, 11, 0.05), loop(1, 11, 1.0), loop(2, 11, 0.3)};
  const LoopClosing::Round round = loops.judge(graph, matches, path_to(12));
  ASSERT_EQ(round.added.size(), 1U);
  EXPECT_EQ(round.added[0].from, 0U);
  ASSERT_EQ(graph.edges().size(), steps + 1);
  EXPECT_EQ(graph.edges().back().from, 0U);
  ASSERT_EQ(round.pending.size(), 1U);
  EXPECT_EQ(round.pending[0].from, 1U);
  EXPECT_TRUE(round.moves);
  ASSERT_EQ(loops.waiting().size(), 1U);
  EXPECT_EQ(loops.waiting()[0].from, 2U);
}

TEST(LoopClosing, ARoundDecidesFirstOnMatchesThatTheirGateRefused) {
  PoseGraph graph = straight(12);
  LoopClosing loops({});
  const std::vector matches{loop(0, 11, 0.05), doubted(loop(1, 11, 0.05))};
  const LoopClosing::Round round = loops.judge(graph, matches, path_to(12));
  EXPECT_FALSE(round.moves);
  ASSERT_EQ(loops.decisions().size(), 2U);
  EXPECT_EQ(loops.decisions()[0].outcome, LoopOutcome::kGate);
  EXPECT_EQ(loops.decisions()[1].outcome, LoopOutcome::kAccepted);
}

TEST(LoopClosing, DoubtfulMatchesThatAgreeAreAcceptedTogether) {
  PoseGraph graph = straight(40);
  const std::vector<double> path_m = path_to(40);
  std::vector<StopMatch> matches;
  for (std::uint32_t i = 0; i < 6; ++i) matches.push_back(doubted(loop(i, 30 + i, 1.0)));
  LoopClosing loops({});
  EXPECT_TRUE(loops.judge(graph, matches, path_m).moves);
  EXPECT_GE(loops.waiting().size(), 4U);
  ASSERT_EQ(loops.decisions().size(), 6U + loops.waiting().size());
  const LoopDecision& decision = loops.decisions()[6];
  EXPECT_EQ(decision.outcome, LoopOutcome::kAccepted);
  EXPECT_GE(decision.evidence.agreement, 4.0);
  EXPECT_EQ(decision.evidence.rival_agreement, 0.0);
  EXPECT_FALSE(loops.judge(graph, {}, path_m).moves);
}

TEST(LoopClosing, DoubtfulMatchesThatAreNotPlausibleProveNothing) {
  PoseGraph graph = straight(40);
  std::vector<StopMatch> matches;
  for (std::uint32_t i = 0; i < 6; ++i) {
    matches.push_back(doubted(loop(i, 30 + i, 1.0)));
    matches.back().rivalry = 0.95;
  }
  LoopClosing loops({});
  EXPECT_FALSE(loops.judge(graph, matches, path_to(40)).moves);
  EXPECT_TRUE(loops.waiting().empty());
}

TEST(LoopClosing, ALoopThatIsOutvotedIsLessProbableThanBefore) {
  const PoseGraph graph = straight(12);
  LoopClosing loops({});
  loops.accept(graph, loop(0, 11, 0.3));
  loops.outvote(graph, loops.waiting());
  ASSERT_EQ(loops.decisions().size(), 2U);
  const LoopDecision& accepted = loops.decisions()[0];
  const LoopDecision& outvoted = loops.decisions()[1];
  EXPECT_EQ(outvoted.outcome, LoopOutcome::kOutvoted);
  EXPECT_EQ(outvoted.evidence.kind, accepted.evidence.kind);
  EXPECT_TRUE(outvoted.evidence.contradicted);
  EXPECT_LT(outvoted.probability, accepted.probability);
  EXPECT_EQ(outvoted.fitness, accepted.fitness);
}

TEST(LoopClosing, GivesWaitingLoopsAwayInTheirOrder) {
  const PoseGraph graph = straight(12);
  LoopClosing loops({});
  for (std::uint32_t i = 0; i < 3; ++i) loops.accept(graph, loop(i, 11, 0.2));
  const std::vector<PoseGraphEdge> first = loops.release(2);
  ASSERT_EQ(first.size(), 2U);
  EXPECT_EQ(first[1].from, 1U);
  ASSERT_EQ(loops.waiting().size(), 1U);
  EXPECT_EQ(loops.waiting()[0].from, 2U);
  EXPECT_EQ(loops.release(9).size(), 1U);
  EXPECT_TRUE(loops.release(1).empty());
}

TEST(LoopClosing, RecordsWhatGateAndOptimisationRefuse) {
  PoseGraph graph = straight(12);
  LoopClosing loops({});
  StopMatch refused = loop(0, 11, 2.0, 0.4);
  refused.verdict = Verdict::kRejected;
  refused.reason = Reason::kFewInliers;
  loops.judge(graph, {&refused, 1}, path_to(12));
  const std::vector outvoted{loop(1, 10, 0.5).edge, loop(2, 9, 0.5).edge};
  loops.outvote(graph, outvoted);
  ASSERT_EQ(loops.decisions().size(), 3U);
  EXPECT_EQ(loops.decisions()[0].outcome, LoopOutcome::kGate);
  EXPECT_EQ(loops.decisions()[0].reason, Reason::kFewInliers);
  EXPECT_EQ(loops.decisions()[2].outcome, LoopOutcome::kOutvoted);
  EXPECT_EQ(loops.decisions()[2].later_id, 9U);
  EXPECT_EQ(loops.decisions()[2].step, 11U);
  EXPECT_EQ(loops.outvoted(), 2U);
}

}  // namespace
}  // namespace topogeo::localization
