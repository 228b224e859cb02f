// The search on chains along x with results worked by hand. The backward correction of the thesis
// tests it with constraints and against all combinations.
#include "loop/loop_search.hpp"

#include <cmath>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace topogeo::localization {
namespace {

Eigen::Matrix3d deviations(double sigma_m, double sigma_rad) {
  return Eigen::Vector3d(sigma_m * sigma_m, sigma_m * sigma_m, sigma_rad * sigma_rad).asDiagonal();
}

RelativeSolution step_of(double x_m, double fitness) {
  return {{x_m, 0.0, 0.0}, deviations(0.05, 0.01), fitness};
}

// Poses 1 m apart, each known to `sigma_m`.
std::vector<LoopPose> chain(std::size_t poses, double sigma_m) {
  std::vector<LoopPose> loop(poses);
  for (std::size_t k = 1; k < poses; ++k) {
    loop[k].T_first_this = {{1.0 * static_cast<double>(k), 0.0, 0.0}, deviations(sigma_m, 0.05)};
    loop[k].steps = {step_of(1.0, 0.8)};
  }
  return loop;
}

LoopCandidate candidate_at(double x_m, double fitness) {
  return {{{x_m, 0.0, 0.0}, deviations(0.05, 0.01)}, fitness};
}

LoopSearchConfig exact() {
  LoopSearchConfig config;
  config.draw = false;
  return config;
}

TEST(LoopSearch, SumsTheFitnessOfCandidateAndSteps) {
  const std::vector<LoopPose> loop = chain(4, 0.1);
  const std::vector candidates{candidate_at(3.0, 0.5)};
  const LoopSearchResult found = search_loop(loop, candidates, exact());
  ASSERT_EQ(found.outcome, LoopSearchOutcome::kClosed);
  ASSERT_EQ(found.paths.size(), 1U);
  EXPECT_NEAR(found.paths[0].summed_fitness, 0.5 + 3 * 0.8, 1e-12);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(found.paths[0].T_first_pose[k].x_m, 1.0 * static_cast<double>(k), 1e-12);
  }
  EXPECT_EQ(found.nearest, 1U);
  EXPECT_EQ(found.backtracks, 0U);
}

TEST(LoopSearch, TakesTheCandidateThatSumsUpToMore) {
  std::vector<LoopPose> loop = chain(3, 1.0);
  // Starting at 2.4, only the poor step of 1.4 leads back near the first pose.
  loop[2].steps.push_back(step_of(1.4, 0.2));
  const std::vector candidates{candidate_at(2.4, 0.9), candidate_at(2.0, 0.7)};
  const LoopSearchResult found = search_loop(loop, candidates, exact());
  ASSERT_EQ(found.outcome, LoopSearchOutcome::kClosed);
  EXPECT_EQ(found.paths.front().candidate, 1U);
  EXPECT_NEAR(found.paths.front().summed_fitness, 0.7 + 0.8 + 0.8, 1e-12);
}

TEST(LoopSearch, ADrawnStepSpreadsAGap) {
  std::vector<LoopPose> loop = chain(3, 0.05);
  loop[2].T_first_this.covariance = deviations(0.07, 0.05);
  LoopSearchConfig config;
  config.resolution_m = 0.01;
  const std::vector candidates{candidate_at(2.16, 0.8)};
  EXPECT_EQ(search_loop(loop, candidates, config).outcome, LoopSearchOutcome::kClosed);
  config.draw = false;
  EXPECT_EQ(search_loop(loop, candidates, config).outcome, LoopSearchOutcome::kDeadEnd);
}

class NotBelow : public LoopConstraint {
 public:
  explicit NotBelow(double x_m) : x_m_(x_m) {}
  [[nodiscard]] bool allows(std::uint32_t pose, const LoopNode& node) const override {
    // The path from this pose must reach the last one.
    std::uint32_t last = pose;
    for (const LoopNode* behind = node.next; behind != nullptr; behind = behind->next) ++last;
    EXPECT_EQ(last, 3U);
    return node.T_first_pose.x_m >= x_m_;
  }

 private:
  double x_m_;
};

TEST(LoopSearch, KeepsToItsConstraintAndReportsHowFarItCame) {
  const std::vector<LoopPose> loop = chain(4, 0.1);
  const std::vector candidates{candidate_at(3.0, 0.5)};
  const NotBelow no_first(1.5);
  const LoopSearchResult stuck = search_loop(loop, candidates, exact(), &no_first);
  EXPECT_EQ(stuck.outcome, LoopSearchOutcome::kDeadEnd);
  EXPECT_EQ(stuck.nearest, 2U);
  EXPECT_TRUE(stuck.paths.empty());
  const NotBelow none(5.0);
  EXPECT_EQ(search_loop(loop, candidates, exact(), &none).outcome,
            LoopSearchOutcome::kCandidatesOutside);
  const NotBelow all(0.0);
  EXPECT_EQ(search_loop(loop, candidates, exact(), &all).outcome, LoopSearchOutcome::kClosed);
}

TEST(LoopSearch, WithoutACandidateThereIsNothingToSearch) {
  EXPECT_EQ(search_loop(chain(4, 0.1), {}).outcome, LoopSearchOutcome::kNoCandidates);
}

TEST(LoopSearch, RefusesBadInput) {
  const std::vector<LoopPose> loop = chain(3, 0.1);
  const std::vector candidates{candidate_at(2.0, 0.5)};
  EXPECT_THROW(search_loop(chain(1, 0.1), candidates), std::invalid_argument);
  std::vector<LoopPose> bad = loop;
  bad[2].steps.clear();
  EXPECT_THROW(search_loop(bad, candidates), std::invalid_argument);
  bad = loop;
  bad[1].T_first_this.covariance(0, 0) = -1.0;
  EXPECT_THROW(search_loop(bad, candidates), std::invalid_argument);
  EXPECT_THROW(search_loop(loop, std::vector{candidate_at(2.0, 1.1)}), std::invalid_argument);
  EXPECT_THROW(search_loop(loop, std::vector{candidate_at(2.0, std::nan(""))}),
               std::invalid_argument);
  LoopSearchConfig config;
  config.beam_width = 0;
  EXPECT_THROW(search_loop(loop, candidates, config), std::invalid_argument);
  config = {};
  config.resolution_m = 0.0;
  EXPECT_THROW(search_loop(loop, candidates, config), std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::localization
