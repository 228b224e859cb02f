#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/matching/fitness_forms.hpp"
#include "topogeo/matching/matcher.hpp"
#include "topogeo/support/random.hpp"

#include "localization/hand_scenes.hpp"
#include "localization/simulated_maps.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;
using Spoil = std::function<void(MatchResult&)>;

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

double next(double value) {
  return std::nextafter(value, kInfinite);
}

// A corridor with equal pillars: each match also fits at a second place.
world::World two_colonnades() {
  world::World world = test::endless_corridor();
  for (int i = -12; i <= 12; ++i) {
    const double x = 0.8 * i + 0.1;
    world.segments.push_back({{x, 1.0}, {x, 0.6}});
    world.segments.push_back({{x, 0.6}, {x + 0.2, 0.6}});
    world.segments.push_back({{x + 0.2, 0.6}, {x + 0.2, 1.0}});
  }
  return world;
}

class MatcherVerifyTest : public testing::Test {
 protected:
  MatcherVerifyTest() {
    for (std::uint32_t id = 0; id < 3; ++id) {
      topomap::LocalMap map;
      map.id = id;
      map.points = test::exact_points(two_colonnades(), {0.3 * id, 0.0, 0.05 * id});
      map.nodes = {test::node(0.4 - 0.3 * id, 0.1, 0.9)};
      maps_.push_back(map);
      worker_.add_map(map);
      client_.add_map(map);
    }
    task_ = test::task_between(maps_[0], maps_[1], {0.2, 0.1, 0.1}, 0.6, 0.15);
    task_.seed = 5;
  }

  void expect_found(const std::vector<std::pair<std::string, Spoil>>& faults) {
    const MatchResult right = worker_.solve(task_);
    ASSERT_EQ(client_.verify(task_, right), "");
    for (const auto& [name, spoil] : faults) {
      MatchResult wrong = right;
      spoil(wrong);
      EXPECT_NE(client_.verify(task_, wrong), "") << name;
    }
  }

  std::vector<topomap::LocalMap> maps_;
  Matcher worker_;
  Matcher client_;
  MatchTask task_;
};

TEST_F(MatcherVerifyTest, FindsNothingWrongWithRightResultsByOtherEvidence) {
  for (const MatchEvidence evidence : {MatchEvidence::kBranches, MatchEvidence::kFitness}) {
    for (const FitnessForm form : fitness_forms()) {
      for (const double finer_m : {0.0, 0.03}) {
        task_.evidence = evidence;
        task_.fitness_form = form;
        task_.genetic.finer_resolution_m = finer_m;
        const MatchResult result = worker_.solve(task_);
        EXPECT_EQ(client_.verify(task_, result), "");
        MatchResult wrong = result;
        wrong.fitness += 0.01;
        EXPECT_NE(client_.verify(task_, wrong), "");
      }
    }
  }
}

TEST_F(MatcherVerifyTest, FindsNothingWrongWithRightResults) {
  int with_second = 0;
  for (const FitnessForm form : fitness_forms()) {
    task_.fitness_form = form;
    for (task_.seed = 0; task_.seed < 40; ++task_.seed) {
      task_.solutions_wanted = 1 + static_cast<std::uint32_t>(task_.seed % 4) * 13;
      const MatchResult result = worker_.solve(task_);
      EXPECT_EQ(client_.verify(task_, result), "");
      EXPECT_EQ(result.status, MatchStatus::kSolved);
      EXPECT_EQ(result.seed, task_.seed);
      with_second += result.second.fitness > 0.0 ? 1 : 0;
    }
  }
  EXPECT_GT(with_second, 0);
}

TEST_F(MatcherVerifyTest, ASearchTooNarrowForASecondPlaceHasNone) {
  task_.half_width = {0.18, 0.18, 0.10};
  for (task_.seed = 0; task_.seed < 10; ++task_.seed) {
    const MatchResult result = worker_.solve(task_);
    EXPECT_EQ(client_.verify(task_, result), "");
    EXPECT_EQ(result.second.fitness, 0.0);
  }
}

TEST_F(MatcherVerifyTest, FindsNothingWrongWithNothingInCommon) {
  task_.T_reference_query = {60.0, 0.0, 0.0};
  const MatchResult nothing = worker_.solve(task_);
  ASSERT_EQ(nothing.status, MatchStatus::kNothingInCommon);
  ASSERT_FALSE(nothing.solutions.empty());
  EXPECT_EQ(client_.verify(task_, nothing), "");
  MatchResult wrong = nothing;
  wrong.T_reference_query.x_m = 60.0;
  EXPECT_NE(client_.verify(task_, wrong), "");
  wrong = nothing;
  wrong.second.fitness = 0.1;
  EXPECT_NE(client_.verify(task_, wrong), "");
  wrong = nothing;
  wrong.status = MatchStatus::kSolved;
  EXPECT_NE(client_.verify(task_, wrong), "");
}

// Changes every number by the smallest possible step and in its sign, and every other field.
TEST_F(MatcherVerifyTest, FindsEverySingleFieldThatIsChanged) {
  task_.seed = 0;
  while (worker_.solve(task_).second.fitness <= 0.0) ASSERT_LT(++task_.seed, 50U);
  std::vector<std::pair<std::string, std::function<double*(MatchResult&)>>> numbers{
      {"overlap", [](MatchResult& r) { return &r.overlap; }},
      {"inliers", [](MatchResult& r) { return &r.inliers; }},
      {"violations", [](MatchResult& r) { return &r.violations; }},
      {"residual", [](MatchResult& r) { return &r.residual_rms_m; }},
      {"scan fitness", [](MatchResult& r) { return &r.scan_fitness; }},
      {"topological fitness", [](MatchResult& r) { return &r.topological_fitness; }},
      {"fitness", [](MatchResult& r) { return &r.fitness; }},
      {"second", [](MatchResult& r) { return &r.second.fitness; }},
      {"first solution", [](MatchResult& r) { return &r.solutions.front().fitness; }},
      {"last solution", [](MatchResult& r) { return &r.solutions.back().fitness; }},
  };
  for (int i = 0; i < 9; ++i) {
    numbers.emplace_back("covariance " + std::to_string(i),
                         [i](MatchResult& r) { return &r.covariance(i); });
  }
  std::vector<std::pair<std::string, Spoil>> faults;
  for (const auto& number : numbers) {
    const std::string& name = number.first;
    const auto at = number.second;
    faults.emplace_back(name + " up", [at](MatchResult& r) { *at(r) = next(*at(r)); });
    faults.emplace_back(name + " negative", [at](MatchResult& r) { *at(r) = -*at(r); });
    faults.emplace_back(name + " nan", [at](MatchResult& r) { *at(r) = kNan; });
    faults.emplace_back(name + " infinite", [at](MatchResult& r) { *at(r) = kInfinite; });
  }
  const std::vector<std::pair<std::string, Spoil>> others{
      {"task id", [](MatchResult& r) { ++r.task_id; }},
      {"seed", [](MatchResult& r) { ++r.seed; }},
      {"status", [](MatchResult& r) { r.status = MatchStatus::kNothingInCommon; }},
      {"verdict",
       [](MatchResult& r) {
         r.verdict = r.verdict == Verdict::kRejected ? Verdict::kAccepted : Verdict::kRejected;
       }},
      {"reason",
       [](MatchResult& r) {
         r.reason = static_cast<Reason>((static_cast<int>(r.reason) + 1) % 7);
       }},
      {"no evaluation", [](MatchResult& r) { r.evaluations = 0; }},
      {"too many evaluations", [](MatchResult& r) { r.evaluations = 50U * 30U + 1U; }},
  };
  faults.insert(faults.end(), others.begin(), others.end());
  expect_found(faults);
}

// The evidence follows from the poses: any other pose, however near, has other evidence.
TEST_F(MatcherVerifyTest, FindsPosesThatAreNotThoseOfTheEvidence) {
  task_.seed = 0;
  while (worker_.solve(task_).second.fitness <= 0.0) ASSERT_LT(++task_.seed, 50U);
  std::vector<std::pair<std::string, Spoil>> faults;
  const std::vector<std::pair<std::string, std::function<Pose2&(MatchResult&)>>> poses{
      {"refined", [](MatchResult& r) -> Pose2& { return r.T_reference_query; }},
      {"second", [](MatchResult& r) -> Pose2& { return r.second.T_reference_query; }},
      {"first", [](MatchResult& r) -> Pose2& { return r.solutions.front().T_reference_query; }},
      {"last", [](MatchResult& r) -> Pose2& { return r.solutions.back().T_reference_query; }},
  };
  for (const auto& pose : poses) {
    const std::string& name = pose.first;
    const auto at = pose.second;
    faults.emplace_back(name + " moved", [at](MatchResult& r) { at(r).x_m += 1e-4; });
    faults.emplace_back(name + " aside", [at](MatchResult& r) { at(r).y_m -= 1e-4; });
    faults.emplace_back(name + " turned", [at](MatchResult& r) { at(r).theta_rad += 1e-4; });
    faults.emplace_back(name + " far", [at](MatchResult& r) { at(r).x_m = 1e30; });
    faults.emplace_back(name + " nan", [at](MatchResult& r) { at(r).y_m = kNan; });
    faults.emplace_back(name + " infinite", [at](MatchResult& r) { at(r).x_m = -kInfinite; });
    faults.emplace_back(name + " heading",
                        [at](MatchResult& r) { at(r).theta_rad += 2.0 * std::numbers::pi; });
  }
  expect_found(faults);
}

TEST_F(MatcherVerifyTest, FindsSolutionsThatSolveWouldNotChoose) {
  task_.solutions_wanted = 3;
  const std::vector<std::pair<std::string, Spoil>> faults{
      {"none", [](MatchResult& r) { r.solutions.clear(); }},
      {"too many", [](MatchResult& r) { r.solutions.resize(4); }},
      {"twice", [](MatchResult& r) { r.solutions[1] = r.solutions[0]; }},
      {"out of order", [](MatchResult& r) { std::swap(r.solutions[0], r.solutions[2]); }},
      {"the second is the first",
       [](MatchResult& r) {
         r.second = {r.T_reference_query, r.fitness};
       }},
  };
  expect_found(faults);
}

// The numbers are right for a place out of reach; only the search space reveals it.
TEST_F(MatcherVerifyTest, FindsSolutionsOutsideOfTheSearchSpace) {
  MatchTask wider = task_;
  wider.half_width *= 1.5;
  wider.solutions_wanted = task_.solutions_wanted = 40;
  const MatchResult outside = worker_.solve(wider);
  EXPECT_EQ(client_.verify(wider, outside), "");
  EXPECT_NE(client_.verify(task_, outside).find("search space"), std::string::npos);
}

// Results of another task, of other maps and of another form are valid there, and wrong here.
TEST_F(MatcherVerifyTest, FindsTheResultOfAnotherTask) {
  const MatchResult result = worker_.solve(task_);
  const std::vector<std::pair<std::string, std::function<void(MatchTask&)>>> changes{
      {"query",
       [&](MatchTask& t) {
         t.query_map_id = 2;
         t.query_hash = topomap::content_hash(maps_[2]);
       }},
      {"form", [](MatchTask& t) { t.fitness_form = FitnessForm::kTopological; }},
      {"prior", [](MatchTask& t) { t.covariance *= 1.01; }},
      {"seed", [](MatchTask& t) { t.seed = 6; }},
      {"gate", [](MatchTask& t) { t.gate.smallest_overlap = 1.1; }},
      {"fewer solutions", [](MatchTask& t) { t.solutions_wanted = 1; }},
  };
  for (const auto& [name, change] : changes) {
    MatchTask other = task_;
    change(other);
    EXPECT_NE(client_.verify(other, result), "") << name;
  }
}

TEST_F(MatcherVerifyTest, ThrowsLikeSolve) {
  const MatchResult result = worker_.solve(task_);
  MatchTask spoilt = task_;
  ++spoilt.query_hash;
  EXPECT_THROW(static_cast<void>(client_.verify(spoilt, result)), std::out_of_range);
  spoilt = task_;
  spoilt.half_width.x() = kNan;
  EXPECT_THROW(static_cast<void>(client_.verify(spoilt, result)), std::invalid_argument);
}

TEST(MatcherFingerprintTest, IsTheSameEachTime) {
  EXPECT_EQ(matcher_fingerprint(), matcher_fingerprint());
  EXPECT_NE(matcher_fingerprint(), 0U);
}

}  // namespace
}  // namespace topogeo::localization
