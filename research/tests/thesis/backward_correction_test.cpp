#include "topogeo/thesis/backward_correction.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <stdexcept>
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "backward_problems.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;
using test::covariance_of;

// --- the oracle: every combination of candidate and stored solutions, as the thesis defines it

struct OracleWay {
  double fitness = -1.0;
  std::vector<Pose2> poses;
};

class Oracle {
 public:
  Oracle(const test::Loop& loop, const BackwardConfig& config) : loop_(loop), config_(config) {}

  OracleWay best() {
    const auto last = static_cast<std::uint32_t>(problem().poses.size() - 1);
    poses_.assign(last + 1, Pose2{});
    for (const BackwardCandidate& candidate : problem().candidates) {
      via_ = candidate.via;
      poses_[last] = candidate.T_first_last.T_a_b;
      const Pose2 T_first_via = via_ == 0 ? Pose2{} : problem().poses[via_].T_first_this.T_a_b;
      if (inside(last) && sees(last, poses_[last], via_, T_first_via)) {
        walk(last, candidate.fitness);
      }
    }
    return best_;
  }

 private:
  [[nodiscard]] const BackwardProblem& problem() const { return loop_.problem; }

  [[nodiscard]] bool inside(std::uint32_t k) const {
    const UncertainPose& expected = problem().poses[k].T_first_this;
    const Eigen::Vector3d half =
        search_half_width(expected.covariance, config_.probability, config_.heading_sigmas);
    const Eigen::Vector3d off = geometry::difference(poses_[k], expected.T_a_b);
    return std::fabs(off.x()) <= std::max(half.x(), config_.resolution_m) &&
           std::fabs(off.y()) <= std::max(half.y(), config_.resolution_m) &&
           std::fabs(off.z()) <= std::max(half.z(), config_.resolution_rad);
  }
  [[nodiscard]] bool sees(std::uint32_t later, const Pose2& T_first_later, std::uint32_t earlier,
                          const Pose2& T_first_earlier) const {
    return overlap(seen_from(problem().poses[later].view,
                             geometry::between(T_first_earlier, T_first_later), {0.0, 0.0, 0.0}),
                   problem().poses[earlier].view);
  }
  [[nodiscard]] bool accepted(std::uint32_t k) const {
    if (!inside(k)) return false;
    const auto last = static_cast<std::uint32_t>(problem().poses.size() - 1);
    for (std::uint32_t later = k + 1; later <= last; ++later) {
      const auto& overlaps = problem().poses[later].overlaps;
      const bool overlapped = std::find(overlaps.begin(), overlaps.end(), k) != overlaps.end();
      if (((overlapped && later != last) || (later == last && via_ == k)) &&
          !sees(later, poses_[later], k, poses_[k])) {
        return false;
      }
    }
    return true;
  }
  void walk(std::uint32_t k, double fitness) {
    if (k == 1) {
      double first = 0.0;
      for (const RelativeSolution& solution : loop_.solutions.find(0, 1)) {
        const Eigen::Vector3d off = geometry::difference(poses_[1], solution.T_earlier_later);
        const double d2 = off.dot(solution.covariance.inverse() * off);
        first = std::max(first, solution.fitness * std::exp(-0.5 * d2));
      }
      if (fitness + first > best_.fitness) best_ = {fitness + first, poses_};
      return;
    }
    for (const RelativeSolution& solution : loop_.solutions.find(k - 1, k)) {
      poses_[k - 1] = poses_[k] * geometry::inverse(solution.T_earlier_later);
      if (accepted(k - 1)) walk(k - 1, fitness + solution.fitness);
    }
  }

  const test::Loop& loop_;
  BackwardConfig config_;
  std::uint32_t via_ = 0;
  std::vector<Pose2> poses_;
  OracleWay best_;
};

TEST(BackwardCorrection, FindsTheWinnerOfAllCombinations) {
  BackwardConfig config;
  config.draw = false;
  config.beam_width = 100'000;
  config.waiting = 100'000;
  config.largest_work = 100'000'000;
  int closed = 0;
  int refused = 0;
  int not_greedy = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    support::Random random(seed);
    test::LoopOptions options;
    options.poses = 5 + static_cast<std::uint32_t>(random.below(3));
    options.solutions_per_step = 2 + static_cast<std::uint32_t>(random.below(2));
    options.candidates = 4;
    options.heading_bias_rad = random.uniform(-0.03, 0.03);
    test::Loop loop = test::circle(options, seed);
    for (BackwardPose& pose : loop.problem.poses) pose.view = {{0.0, -1.0}, {2.0, 1.0}};
    for (BackwardCandidate& candidate : loop.problem.candidates) {
      candidate.via = static_cast<std::uint32_t>(random.below(options.poses - 2));
      candidate.T_first_last.T_a_b.x_m -= random.uniform(0.0, 0.5);
    }
    const BackwardResult found = correct_backward(loop.problem, loop.solutions, config);
    const OracleWay expected = Oracle(loop, config).best();
    SCOPED_TRACE(seed);
    if (expected.fitness < 0.0) {
      ++refused;
      EXPECT_NE(found.outcome, LoopSearchOutcome::kClosed);
      EXPECT_TRUE(found.paths.empty());
      continue;
    }
    ++closed;
    ASSERT_EQ(found.outcome, LoopSearchOutcome::kClosed);
    EXPECT_NEAR(found.paths.front().summed_fitness, expected.fitness, 1e-9);
    for (std::size_t k = 1; k < expected.poses.size(); ++k) {
      EXPECT_LT(geometry::difference(found.paths.front().T_first_pose[k], expected.poses[k]).norm(),
                1e-9);
    }
    double greedy = loop.problem.candidates[found.paths.front().candidate].fitness;
    for (std::uint32_t k = 1; k < options.poses; ++k)
      greedy += loop.solutions.find(k - 1, k)[0].fitness;
    not_greedy += expected.fitness < greedy - 0.2 ? 1 : 0;
  }
  // All three cases must occur, or this test proves little.
  EXPECT_GT(closed, 10);
  EXPECT_GT(refused, 5);
  EXPECT_GT(not_greedy, 5);
}

// --- a hand-worked chain along x: poses 1 m apart, none of them turned

struct Line {
  BackwardProblem problem;
  SolutionStore solutions;

  // sigma_m[k]: uncertainty of pose k + 1 in the forward correction.
  explicit Line(const std::vector<double>& sigma_m) {
    problem.poses.resize(sigma_m.size() + 1);
    for (std::uint32_t k = 0; k < problem.poses.size(); ++k) {
      BackwardPose& pose = problem.poses[k];
      pose.view = {{0.0, -5.0}, {5.0, 5.0}};
      if (k == 0) continue;
      pose.T_first_this = {{1.0 * k, 0.0, 0.0}, covariance_of(sigma_m[k - 1], 0.05)};
      pose.T_previous_this = {{1.0, 0.0, 0.0}, covariance_of(0.2, 0.05)};
      pose.overlaps = {k - 1};
    }
  }
  void add(std::uint32_t later, const std::vector<std::pair<double, double>>& step_and_fitness) {
    std::vector<RelativeSolution> found;
    found.reserve(step_and_fitness.size());
    for (const auto& [step_m, fitness] : step_and_fitness) {
      found.push_back({{step_m, 0.0, 0.0}, covariance_of(0.05, 0.01), fitness});
    }
    solutions.put(later - 1, later, found);
  }
  void candidate(double x_m, double fitness) {
    problem.candidates.push_back({0, {{x_m, 0.0, 0.0}, covariance_of(0.05, 0.01)}, fitness});
  }
};

TEST(BackwardCorrection, TurnsBackFromADeadEnd) {
  // The last pose must be 3.6 m on. The fitter solution of the last step, 1 m, leaves pose 2 at 2.6
  // m, and no solution leads from there to pose 1 near 1 m; the poorer one, 1.6 m, does.
  Line line({0.02, 1.0, 1.0});
  line.add(1, {{1.0, 0.9}});
  line.add(2, {{1.0, 0.9}});
  line.add(3, {{1.0, 0.9}, {1.6, 0.5}});
  line.candidate(3.6, 0.7);
  BackwardConfig config;
  config.draw = false;
  config.beam_width = 1;
  const BackwardResult found = correct_backward(line.problem, line.solutions, config);
  ASSERT_EQ(found.outcome, LoopSearchOutcome::kClosed);
  EXPECT_EQ(found.backtracks, 1U);
  EXPECT_NEAR(found.paths.front().summed_fitness, 0.7 + 0.5 + 0.9 + 0.9, 1e-12);
  EXPECT_NEAR(found.paths.front().T_first_pose[2].x_m, 2.0, 1e-12);
  EXPECT_NEAR(found.paths.front().T_first_pose[1].x_m, 1.0, 1e-12);

  config.waiting = 0;  // no backtracking
  const BackwardResult lost = correct_backward(line.problem, line.solutions, config);
  EXPECT_EQ(lost.outcome, LoopSearchOutcome::kDeadEnd);
  EXPECT_EQ(lost.nearest_id, 2U);
  EXPECT_TRUE(lost.paths.empty());
}

TEST(BackwardCorrection, SpreadsAGapThatNoStoredSolutionCloses) {
  Line line({0.05, 0.07, 0.087, 0.1});
  for (std::uint32_t k = 1; k <= 4; ++k) line.add(k, {{1.0, 0.8}});
  line.candidate(4.2, 0.8);
  BackwardConfig config;
  config.resolution_m = 0.01;
  config.draw = false;
  EXPECT_EQ(correct_backward(line.problem, line.solutions, config).outcome,
            LoopSearchOutcome::kDeadEnd);
  config.draw = true;
  const BackwardResult found = correct_backward(line.problem, line.solutions, config);
  ASSERT_EQ(found.outcome, LoopSearchOutcome::kClosed);
  // Five equal links, including the closing one, share 0.2 m.
  for (std::uint32_t k = 1; k <= 4; ++k) {
    EXPECT_NEAR(found.paths.front().T_first_pose[k].x_m, 1.04 * k, 0.01) << k;
  }
}

TEST(BackwardCorrection, RefusesPosesFromWhichTheMapsDoNotOverlapAnyMore) {
  // The uncertainty would permit any pose 2, but pose 3 saw the map of 1 and cannot from 9 m on.
  Line line({0.05, 5.0, 5.0, 5.0});
  for (std::uint32_t k = 1; k <= 4; ++k) line.add(k, {{1.0, 0.5}});
  line.add(3, {{7.0, 0.9}, {1.0, 0.5}});
  line.candidate(4.0, 0.8);
  line.problem.poses[3].overlaps = {1, 2};
  BackwardConfig config;
  config.draw = false;
  const BackwardResult found = correct_backward(line.problem, line.solutions, config);
  ASSERT_EQ(found.outcome, LoopSearchOutcome::kClosed);
  EXPECT_NEAR(found.paths.front().T_first_pose[2].x_m, 2.0, 1e-12);
}

TEST(BackwardCorrection, SaysWhyItFailed) {
  Line line({0.05, 0.07, 0.09});
  for (std::uint32_t k = 1; k <= 3; ++k) line.add(k, {{1.0, 0.8}});
  EXPECT_EQ(correct_backward(line.problem, line.solutions).outcome,
            LoopSearchOutcome::kNoCandidates);
  line.candidate(9.0, 0.9);
  const BackwardResult outside = correct_backward(line.problem, line.solutions);
  EXPECT_EQ(outside.outcome, LoopSearchOutcome::kCandidatesOutside);
  EXPECT_EQ(outside.nearest_id, 3U);
  line.candidate(3.0, 0.9);
  EXPECT_EQ(correct_backward(line.problem, line.solutions).outcome, LoopSearchOutcome::kClosed);
  BackwardConfig config;
  config.largest_work = 0;
  EXPECT_EQ(correct_backward(line.problem, line.solutions, config).outcome,
            LoopSearchOutcome::kTooMuchWork);
  EXPECT_STREQ(to_string(LoopSearchOutcome::kDeadEnd), "dead end");
}

// --- a loop of 60 poses, 90 m round, as in experiment 2 of the thesis

double largest_error_m(const std::vector<Pose2>& poses, const std::vector<Pose2>& truth) {
  double largest_m = 0.0;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    largest_m = std::max(largest_m, (poses[k].position_m() - truth[k].position_m()).norm());
  }
  return largest_m;
}

TEST(BackwardCorrection, PicksTheRightClosingAmongWrongOnes) {
  int right = 0;
  double forward_m = 0.0;
  double backward_m = 0.0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    test::LoopOptions options;
    options.heading_bias_rad = 0.002;
    const test::Loop loop = test::circle(options, seed);
    const BackwardResult found = correct_backward(loop.problem, loop.solutions);
    SCOPED_TRACE(seed);
    ASSERT_EQ(found.outcome, LoopSearchOutcome::kClosed);
    if (found.paths.front().candidate != 0) continue;
    ++right;
    std::vector<Pose2> forward;
    for (const BackwardPose& pose : loop.problem.poses) forward.push_back(pose.T_first_this.T_a_b);
    forward_m += largest_error_m(forward, loop.T_first_true);
    backward_m += largest_error_m(found.paths.front().T_first_pose, loop.T_first_true);
  }
  EXPECT_GE(right, 18);
  EXPECT_GT(forward_m / right, 1.5);
  EXPECT_LT(backward_m, 0.6 * forward_m);
}

TEST(BackwardCorrection, GivesTheSameBitsAgainAndKeepsToItsWork) {
  const test::Loop loop = test::circle({}, 5);
  const BackwardResult a = correct_backward(loop.problem, loop.solutions);
  const BackwardResult b = correct_backward(loop.problem, loop.solutions);
  ASSERT_FALSE(a.paths.empty());
  EXPECT_EQ(a.paths.size(), 3U);
  EXPECT_EQ(a.paths.front().T_first_pose, b.paths.front().T_first_pose);
  EXPECT_EQ(a.expanded, b.expanded);
  const BackwardConfig config;
  EXPECT_LE(a.expanded, 59U * config.beam_width);
  for (std::size_t i = 1; i < a.paths.size(); ++i) {
    EXPECT_LE(a.paths[i].summed_fitness, a.paths[i - 1].summed_fitness);
  }
}

TEST(BackwardCorrection, RefusesBadInput) {
  Line line({0.05, 0.07});
  line.add(1, {{1.0, 0.8}});
  line.candidate(2.0, 0.9);
  const auto refused = [&](const std::function<void(BackwardProblem&, BackwardConfig&)>& spoil) {
    BackwardProblem problem = line.problem;
    BackwardConfig config;
    spoil(problem, config);
    EXPECT_THROW(correct_backward(problem, line.solutions, config), std::invalid_argument);
  };
  refused([](auto& p, auto&) { p.poses.resize(1); });
  refused([](auto& p, auto&) { p.poses[1].T_first_this.covariance(0, 0) = -1.0; });
  refused([](auto& p, auto&) { p.poses[2].T_previous_this.covariance(2, 2) = std::nan(""); });
  refused([](auto& p, auto&) { p.poses[1].overlaps = {1}; });
  refused([](auto& p, auto&) { p.candidates[0].via = 2; });
  refused([](auto& p, auto&) { p.candidates[0].fitness = 1.2; });
  refused([](auto& p, auto&) { p.candidates[0].T_first_last.covariance.setZero(); });
  refused([](auto&, auto& c) { c.beam_width = 0; });
  refused([](auto&, auto& c) { c.resolution_m = 0.0; });
}

}  // namespace
}  // namespace topogeo::localization
