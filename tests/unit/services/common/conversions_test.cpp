#include "topogeo/service/conversions.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/map_client/map_follower.hpp"
#include "topogeo/service/decision_assembly.hpp"
#include "topogeo/service/edge_assembly.hpp"
#include "topogeo/service/trajectory_assembly.hpp"

#include "services/common/random_values.hpp"

namespace topogeo::service {
namespace {

using testing::HasSubstr;

class Conversions : public testing::TestWithParam<std::uint64_t> {
 protected:
  support::Random random_{GetParam()};
};
INSTANTIATE_TEST_SUITE_P(Seeds, Conversions, testing::Range(std::uint64_t{1}, std::uint64_t{21}));

TEST_P(Conversions, ScanIsExact) {
  const scan::Scan scan = any_scan(random_);
  const scan::Scan back = from_msg(to_msg(scan, "robot"));
  EXPECT_EQ(back.sequence, scan.sequence);
  EXPECT_EQ(back.stamp_ns, scan.stamp_ns);
  EXPECT_EQ(back.angle_min_rad, scan.angle_min_rad);
  EXPECT_EQ(back.angle_step_rad, scan.angle_step_rad);
  EXPECT_EQ(back.ranges_m, scan.ranges_m);
  EXPECT_EQ(back.T_odom_robot, scan.T_odom_robot);
}

TEST_P(Conversions, LocalMapIsExact) {
  const topomap::LocalMap map = any_local_map(random_);
  EXPECT_TRUE(from_msg(to_msg(map)) == map);
}

TEST_P(Conversions, MatchTaskIsExact) {
  localization::MatchTask task;
  task.task_id = random_.next_u64();
  task.reference_map_id = any_u32(random_);
  task.query_map_id = any_u32(random_);
  task.reference_hash = random_.next_u64();
  task.query_hash = random_.next_u64();
  task.T_reference_query = any_pose(random_);
  task.covariance = any_matrix(random_);
  task.half_width = {any_double(random_), any_double(random_), any_double(random_)};
  task.genetic = {any_u32(random_),    any_u32(random_),   any_double(random_), any_double(random_),
                  any_u32(random_),    any_u32(random_),   any_double(random_), any_double(random_),
                  any_double(random_), any_double(random_)};
  task.gate = {any_double(random_), any_double(random_), any_double(random_),
               any_double(random_), any_double(random_), any_double(random_)};
  task.fitness_form = static_cast<localization::FitnessForm>(random_.below(4));
  task.evidence = static_cast<localization::MatchEvidence>(random_.below(3));
  for (int i = 0; i < 7; ++i) task.initial_individuals.push_back(any_pose(random_));
  task.solutions_wanted = 1 + static_cast<std::uint32_t>(random_.below(40));
  task.seed = random_.next_u64();
  const localization::MatchTask back = from_msg(to_msg(task, 1));
  EXPECT_EQ(back.task_id, task.task_id);
  EXPECT_EQ(back.reference_map_id, task.reference_map_id);
  EXPECT_EQ(back.query_map_id, task.query_map_id);
  EXPECT_EQ(back.reference_hash, task.reference_hash);
  EXPECT_EQ(back.query_hash, task.query_hash);
  EXPECT_EQ(back.T_reference_query, task.T_reference_query);
  EXPECT_EQ(back.covariance, task.covariance);
  EXPECT_EQ(back.half_width, task.half_width);
  EXPECT_EQ(back.genetic, task.genetic);
  EXPECT_EQ(back.gate, task.gate);
  EXPECT_EQ(back.fitness_form, task.fitness_form);
  EXPECT_EQ(back.evidence, task.evidence);
  EXPECT_EQ(back.initial_individuals, task.initial_individuals);
  EXPECT_EQ(back.solutions_wanted, task.solutions_wanted);
  EXPECT_EQ(back.seed, task.seed);
  EXPECT_EQ(back.places, nullptr);
}

TEST_P(Conversions, PlaceQuestionIsExact) {
  localization::PlaceQuestion question;
  question.field_hash = random_.next_u64();
  for (int i = 0; i < 5; ++i) question.pieces.push_back({any_u32(random_), random_.next_u64()});
  question.wall_pieces = 3;
  question.margin_m = 8.1;
  question.points = {{1.5F, -2.25F}, {0.1F, 3.0F}};
  question.first_heading = 18;
  question.headings = 6;
  localization::MatchTask task;
  task.places = std::make_shared<const localization::PlaceQuestion>(question);
  const auto back = from_msg(to_msg(task, 1)).places;
  ASSERT_NE(back, nullptr);
  EXPECT_EQ(back->field_hash, question.field_hash);
  ASSERT_EQ(back->pieces.size(), question.pieces.size());
  for (std::size_t i = 0; i < question.pieces.size(); ++i) {
    EXPECT_EQ(back->pieces[i].map_id, question.pieces[i].map_id);
    EXPECT_EQ(back->pieces[i].content_hash, question.pieces[i].content_hash);
  }
  EXPECT_EQ(back->wall_pieces, 3U);
  EXPECT_EQ(back->margin_m, 8.1);
  ASSERT_EQ(back->points.size(), 2U);
  EXPECT_EQ(back->points[1].x_m, 0.1F);
  EXPECT_EQ(back->points[0].y_m, -2.25F);
  EXPECT_EQ(back->first_heading, 18U);
  EXPECT_EQ(back->headings, 6U);
}

TEST_P(Conversions, MatchResultIsExact) {
  localization::MatchResult result;
  result.task_id = random_.next_u64();
  result.status = static_cast<localization::MatchStatus>(random_.below(2));
  for (int i = 0; i < 3; ++i) result.solutions.push_back({any_pose(random_), any_double(random_)});
  result.T_reference_query = any_pose(random_);
  result.covariance = any_matrix(random_);
  for (double* value :
       {&result.overlap, &result.inliers, &result.violations, &result.residual_rms_m,
        &result.scan_fitness, &result.topological_fitness, &result.fitness}) {
    *value = any_double(random_);
  }
  result.second = {any_pose(random_), any_double(random_)};
  result.evaluations = any_u32(random_);
  result.seed = random_.next_u64();
  result.verdict = static_cast<localization::Verdict>(random_.below(3));
  result.reason = static_cast<localization::Reason>(random_.below(localization::kReasons));
  const localization::MatchResult back = from_msg(to_msg(result));
  EXPECT_EQ(back.task_id, result.task_id);
  EXPECT_EQ(back.status, result.status);
  ASSERT_EQ(back.solutions.size(), result.solutions.size());
  for (std::size_t i = 0; i < back.solutions.size(); ++i) {
    EXPECT_EQ(back.solutions[i].T_reference_query, result.solutions[i].T_reference_query);
    EXPECT_EQ(back.solutions[i].fitness, result.solutions[i].fitness);
  }
  EXPECT_EQ(back.T_reference_query, result.T_reference_query);
  EXPECT_EQ(back.covariance, result.covariance);
  EXPECT_EQ(back.overlap, result.overlap);
  EXPECT_EQ(back.inliers, result.inliers);
  EXPECT_EQ(back.violations, result.violations);
  EXPECT_EQ(back.residual_rms_m, result.residual_rms_m);
  EXPECT_EQ(back.scan_fitness, result.scan_fitness);
  EXPECT_EQ(back.topological_fitness, result.topological_fitness);
  EXPECT_EQ(back.fitness, result.fitness);
  EXPECT_EQ(back.second.T_reference_query, result.second.T_reference_query);
  EXPECT_EQ(back.second.fitness, result.second.fitness);
  EXPECT_EQ(back.evaluations, result.evaluations);
  EXPECT_EQ(back.seed, result.seed);
  EXPECT_EQ(back.verdict, result.verdict);
  EXPECT_EQ(back.reason, result.reason);
}

TEST_P(Conversions, TrajectoryIsExactInAnyOrderOfItsSegments) {
  const topomap::Trajectory trajectory = any_trajectory(random_, 600);
  std::vector<msg::TrajectorySegment> segments = to_segments(trajectory, "robot", 7);
  ASSERT_EQ(segments.size(), 3U);
  EXPECT_EQ(segments[2].sequence_number(), 9U);
  std::rotate(segments.begin(), segments.begin() + 1 + static_cast<long>(random_.below(2)),
              segments.end());
  TrajectoryAssembly assembly;
  for (const auto& segment : segments) {
    EXPECT_FALSE(assembly.whole(trajectory.version).has_value());
    EXPECT_TRUE(assembly.add(segment));
  }
  ASSERT_TRUE(assembly.whole(trajectory.version).has_value());
  EXPECT_TRUE(*assembly.whole(trajectory.version) == trajectory);
  EXPECT_TRUE(assembly.newest() == trajectory);
}

TEST_P(Conversions, LoopClosuresAreExact) {
  std::vector<topomap::LoopClosure> closures;
  for (int i = 0; i < 30; ++i) {
    const auto earlier = static_cast<std::uint32_t>(random_.below(1000));
    closures.push_back({earlier, earlier + 1, any_pose(random_)});
  }
  EXPECT_TRUE(from_msg(to_msg(closures, 5, "robot", 6, 7)) == closures);
}

TEST_P(Conversions, EdgesAreExactInSegmentsOfAnyOrder) {
  for (const std::size_t count : {0U, 1U, 128U, 129U, 300U}) {
    std::vector<storage::MapEdge> edges;
    for (std::size_t i = 0; i < count; ++i) {
      const auto earlier = static_cast<std::uint32_t>(random_.below(1000));
      edges.push_back({earlier, earlier + 1, any_pose(random_), any_matrix(random_),
                       static_cast<storage::MapEdge::Kind>(random_.below(4))});
    }
    EdgeAssembly assembly;
    for (std::uint32_t segment = edge_segment_count(count); segment-- > 0;) {
      EXPECT_FALSE(assembly.whole(5).has_value());
      assembly.add(to_segment(edges, segment, 5, "robot", 6, segment));
    }
    EXPECT_EQ(assembly.whole(5), edges);
    EXPECT_EQ(assembly.newest(), edges);
    EXPECT_FALSE(assembly.whole(6).has_value());
    // One edge is added, then two segments' last edges go: only the last segment is sent again.
    edges.push_back({1, 2, any_pose(random_), any_matrix(random_), storage::MapEdge::Kind::kLoop});
    const auto last = edge_segment_count(edges.size()) - 1;
    assembly.add(to_segment(edges, last, 6, "robot", 6, 9));
    EXPECT_EQ(assembly.newest(), edges);
    if (count != 300U) continue;
    edges.resize(256);
    assembly.add(to_segment(edges, 1, 7, "robot", 6, 10));
    EXPECT_EQ(assembly.newest(), edges);
    EXPECT_FALSE(assembly.whole(7).has_value()) << "the first one is older";
  }
  msg::MapEdges cut = to_segment({}, 0, 5, "robot", 6, 0);
  cut.total(1);
  EXPECT_THROW(from_msg(cut), std::invalid_argument);
}

TEST_P(Conversions, LivePoseIsExact) {
  const LivePose pose{any_i64(random_),
                      random_.next_u64(),
                      {localization::LocalizationState::kLost, 0.375},
                      msg::kModeLocalization,
                      any_pose(random_),
                      any_matrix(random_),
                      {random_.next_u64(), any_u32(random_)},
                      random_.next_u64()};
  const LivePose back = from_msg(to_msg(pose, "robot"));
  EXPECT_EQ(back.stamp_ns, pose.stamp_ns);
  EXPECT_EQ(back.sequence, pose.sequence);
  EXPECT_EQ(back.status.state, pose.status.state);
  EXPECT_EQ(back.status.confidence, pose.status.confidence);
  EXPECT_EQ(back.mode, pose.mode);
  EXPECT_EQ(back.T_map_robot, pose.T_map_robot);
  EXPECT_EQ(back.covariance, pose.covariance);
  EXPECT_EQ(back.last_stop, pose.last_stop);
  EXPECT_EQ(back.trajectory_version, pose.trajectory_version);
}

TEST_P(Conversions, LoopDecisionsAreExactInSegments) {
  std::vector<localization::LoopDecision> decisions;
  for (std::uint32_t i = 0; i < 600; ++i) {
    localization::LoopDecision decision;
    decision.step = i + 2;
    decision.earlier_id = i;
    decision.later_id = i + 1;
    decision.outcome =
        static_cast<localization::LoopOutcome>(random_.below(localization::kLoopOutcomes));
    decision.reason = static_cast<localization::Reason>(random_.below(localization::kReasons));
    decision.T_earlier_later = any_pose(random_);
    decision.predicted.T_a_b = any_pose(random_);
    for (double& value : decision.predicted.covariance.reshaped()) value = any_double(random_);
    decision.source = static_cast<localization::ProposalSource>(random_.below(3));
    decision.correction_m = any_double(random_);
    decision.correction_rad = any_double(random_);
    decision.fitness = any_double(random_);
    decision.probability = any_double(random_);
    decisions.push_back(decision);
  }
  ASSERT_EQ(decision_segment_count(decisions.size()), 3U);
  DecisionAssembly assembly;
  for (const std::uint32_t segment : {2U, 0U, 1U}) {
    const msg::LoopDecisions message = to_segment(decisions, segment, "robot", 6, segment);
    EXPECT_EQ(message.total(), 600U);
    EXPECT_EQ(message.decisions().front().explanation().to_string(),
              localization::explanation(decisions[std::size_t{256} * segment]));
    assembly.add(message);
  }
  const std::vector<localization::LoopDecision> back = assembly.all();
  ASSERT_EQ(back.size(), decisions.size());
  for (std::size_t i = 0; i < back.size(); ++i) {
    EXPECT_EQ(back[i].step, decisions[i].step);
    EXPECT_EQ(back[i].earlier_id, decisions[i].earlier_id);
    EXPECT_EQ(back[i].later_id, decisions[i].later_id);
    EXPECT_EQ(back[i].outcome, decisions[i].outcome);
    EXPECT_EQ(back[i].reason, decisions[i].reason);
    EXPECT_EQ(back[i].T_earlier_later, decisions[i].T_earlier_later);
    EXPECT_EQ(back[i].predicted.T_a_b, decisions[i].predicted.T_a_b);
    EXPECT_EQ(back[i].predicted.covariance, decisions[i].predicted.covariance);
    EXPECT_EQ(back[i].source, decisions[i].source);
    EXPECT_EQ(back[i].correction_m, decisions[i].correction_m);
    EXPECT_EQ(back[i].correction_rad, decisions[i].correction_rad);
    EXPECT_EQ(back[i].fitness, decisions[i].fitness);
    EXPECT_EQ(back[i].probability, decisions[i].probability);
  }
  EXPECT_THROW(to_segment(decisions, 3, "robot", 6, 0), std::invalid_argument);
  msg::LoopDecisions cut = to_segment(decisions, 0, "robot", 6, 0);
  cut.decisions().pop_back();
  EXPECT_THROW(from_msg(cut), std::invalid_argument);
}

TEST_P(Conversions, LocalizationCommandIsExactAndItsCovarianceIsChecked) {
  LocalizationCommand command{random_.next_u64(), "operator-1", msg::kCommandSetPose,
                              any_pose(random_), Eigen::Vector3d(0.25, 0.5, 0.1).asDiagonal()};
  const LocalizationCommand back = from_msg(to_msg(command, "robot", 6, 7));
  EXPECT_EQ(back.request_id, command.request_id);
  EXPECT_EQ(back.client_id, command.client_id);
  EXPECT_EQ(back.kind, command.kind);
  EXPECT_EQ(back.T_map_robot, command.T_map_robot);
  EXPECT_EQ(back.covariance, command.covariance);
  command.covariance(2, 2) = 0.0;
  EXPECT_THROW(from_msg(to_msg(command, "robot", 6, 7)), std::invalid_argument);
  command.kind = msg::kCommandSearch;
  EXPECT_NO_THROW(from_msg(to_msg(command, "robot", 6, 7)));
}

TEST_P(Conversions, GlobalMapIsExactInAnyOrderOfItsElements) {
  const topomap::GlobalMap map = any_global_map(random_);
  const std::vector<msg::MapElement> elements = to_elements(map, 7, "robot", 1);
  ASSERT_EQ(elements.size(), 51U);
  EXPECT_EQ(elements.back().map_id(), 7U);
  map_client::Map parts;
  parts.version = elements.back().map_version();
  for (std::size_t i = elements.size() - 1; i-- > 0;) {
    const auto element = std::make_shared<const msg::MapElement>(elements[i]);
    (element->kind() == msg::kElementNode ? parts.nodes : parts.branches)[element->id()] = element;
  }
  EXPECT_TRUE(from_elements(parts) == map);
  parts.nodes.erase(parts.branches.begin()->second->node_a());
  EXPECT_THROW(from_elements(parts), std::invalid_argument);
}

/// Message of the std::invalid_argument from `call`.
template <class Call>
std::string refusal(const Call& call) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "not refused";
}

TEST(ConversionBounds, WhatDoesNotFitIsRefusedByName) {
  support::Random random(1);
  scan::Scan scan = any_scan(random);
  scan.ranges_m.resize(2049);
  EXPECT_THAT(refusal([&] { to_msg(scan, "robot"); }),
              "ranges_m has 2049 entries, expected at most 2048");
  EXPECT_THAT(refusal([&] { to_msg(any_scan(random), std::string(33, 'r')); }),
              HasSubstr("robot_id"));
  topomap::LocalMap map = any_local_map(random);
  map.branches[0].points.resize(2049);
  EXPECT_THAT(refusal([&] { to_msg(map); }), HasSubstr("branches.points has 2049"));
  map = any_local_map(random);
  map.track.resize(257);
  EXPECT_THAT(refusal([&] { to_msg(map); }), HasSubstr("track has 257"));
  localization::MatchTask task;
  task.initial_individuals.resize(257);
  EXPECT_THAT(refusal([&] { to_msg(task, 0); }), HasSubstr("initial_individuals has 257"));
  localization::PlaceQuestion question;
  question.pieces.resize(1025);
  localization::MatchTask search;
  search.places = std::make_shared<const localization::PlaceQuestion>(question);
  EXPECT_THAT(refusal([&] { to_msg(search, 0); }), HasSubstr("places.pieces has 1025"));
  EXPECT_THAT(refusal([&] {
                tasks_for({"r", 0, 0, std::string(65, 'w'), "", "", 0});
              }),
              HasSubstr("worker_id"));
  const std::vector<topomap::LoopClosure> closures(msg::kMaxLoopClosures + 1);
  EXPECT_THAT(refusal([&] { to_msg(closures, 0, "r", 0, 0); }),
              HasSubstr("closures has " + std::to_string(closures.size())));
}

TEST(ConversionChecks, NumbersThatAreNoneAreRefused) {
  support::Random random(2);
  const float bad[] = {std::numeric_limits<float>::quiet_NaN(),
                       std::numeric_limits<float>::infinity(), -1.0F};
  for (const float range_m : bad) {
    msg::Scan message = to_msg(any_scan(random), "robot");
    message.ranges_m()[17] = range_m;
    EXPECT_THAT(refusal([&] { from_msg(message); }), HasSubstr("ranges_m"));
  }
  msg::Scan empty = to_msg(any_scan(random), "robot");
  empty.ranges_m().clear();
  EXPECT_THAT(refusal([&] { from_msg(empty); }), HasSubstr("at least one beam"));
}

TEST(ConversionChecks, LocalMapThatContradictsItselfIsRefused) {
  support::Random random(3);
  const msg::LocalMap good = to_msg(any_local_map(random));
  msg::LocalMap message = good;
  message.branches()[3].node_b(20);
  EXPECT_THAT(refusal([&] { from_msg(message); }), HasSubstr("branches.node_b"));
  message = good;
  message.nodes()[3].id(4);
  EXPECT_THAT(refusal([&] { from_msg(message); }), HasSubstr("nodes.id"));
  message = good;
  message.points()[5].x_m(message.points()[5].x_m() + 1.0F);
  EXPECT_THAT(refusal([&] { from_msg(message); }), HasSubstr("content_hash"));
}

TEST(ConversionChecks, RefusalOfATaskIsNoResult) {
  msg::MatchResult message = to_msg(localization::MatchResult{});
  message.status(msg::kMatchMapMissing);
  EXPECT_THAT(refusal([&] { from_msg(message); }), HasSubstr("status"));
}

TEST(ConversionChecks, SegmentWithMissingStopsIsRefused) {
  support::Random random(4);
  msg::TrajectorySegment message = to_segments(any_trajectory(random, 300), "r", 0)[1];
  message.stops().pop_back();
  EXPECT_THAT(refusal([&] { from_msg(message); }), HasSubstr("stops"));
}

TEST(Assembly, NewestOfEachSegmentCountsUntilAVersionIsWhole) {
  support::Random random(5);
  topomap::Trajectory first = any_trajectory(random, 300);
  first.version = 1;
  topomap::Trajectory second = any_trajectory(random, 301);
  second.version = 2;
  TrajectoryAssembly assembly;
  for (const auto& segment : to_segments(first, "r", 0)) assembly.add(segment);
  assembly.add(to_segment(second, 1, "r", 2));
  EXPECT_FALSE(assembly.add(to_segment(first, 1, "r", 3)));  // older
  EXPECT_FALSE(assembly.whole(1).has_value());
  EXPECT_FALSE(assembly.whole(2).has_value());
  const topomap::Trajectory newest = assembly.newest();
  EXPECT_EQ(newest.version, 2U);
  ASSERT_EQ(newest.stops.size(), 301U);
  EXPECT_TRUE(newest.stops[255] == first.stops[255]);
  EXPECT_TRUE(newest.stops[256] == second.stops[256]);
  assembly.add(to_segment(second, 0, "r", 4));
  ASSERT_TRUE(assembly.whole(2).has_value());
  EXPECT_TRUE(*assembly.whole(2) == second);
}

}  // namespace
}  // namespace topogeo::service
