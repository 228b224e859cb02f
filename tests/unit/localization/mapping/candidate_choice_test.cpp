#include "topogeo/slam/candidate_choice.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "localization/hand_scenes.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

std::vector<std::uint32_t> ids(const std::vector<MatchCandidate>& candidates) {
  std::vector<std::uint32_t> found;
  found.reserve(candidates.size());
  for (const MatchCandidate& candidate : candidates) found.push_back(candidate.id);
  return found;
}

/// The L-shaped room seen from its middle, and placed at other poses from there: the farther away,
/// the less of it is in view.
class CandidateChoiceTest : public ::testing::Test {
 protected:
  void consider(CandidateChoice& choice, std::uint32_t id, double x_m) const {
    choice.consider(id, here_.profile, outline_, {Pose2{x_m, 0.0, 0.0}, Eigen::Matrix3d::Zero()});
  }
  [[nodiscard]] double overlap_at(double x_m) const {
    return expected_overlap(here_.profile, outline_,
                            {Pose2{x_m, 0.0, 0.0}, Eigen::Matrix3d::Zero()});
  }

  MatchFeatures here_ = test::features_at(test::l_room(), {0.0, 0.5, 0.0});
  std::vector<SurfacePoint> outline_ = outline_of(here_.coarse);
};

TEST_F(CandidateChoiceTest, TakesTheLargestOverlapsFirst) {
  ASSERT_GT(overlap_at(0.0), overlap_at(1.5));
  ASSERT_GT(overlap_at(1.5), overlap_at(3.0));
  CandidateChoice choice(0.0);
  consider(choice, 2, 3.0);
  consider(choice, 5, 0.0);
  consider(choice, 9, 1.5);
  EXPECT_EQ(ids(choice.best(3)), (std::vector<std::uint32_t>{5, 9, 2}));
  EXPECT_EQ(ids(choice.best(2)), (std::vector<std::uint32_t>{5, 9}));
  EXPECT_TRUE(choice.best(0).empty());
  EXPECT_EQ(choice.best(1).front().overlap, overlap_at(0.0));
}

TEST_F(CandidateChoiceTest, LeavesOutWhatSeesTooLittle) {
  CandidateChoice choice(overlap_at(1.5));
  consider(choice, 0, 0.0);
  consider(choice, 1, 1.5);
  consider(choice, 2, 30.0);
  EXPECT_EQ(ids(choice.best(9)), (std::vector<std::uint32_t>{0, 1}));
}

TEST_F(CandidateChoiceTest, OfEqualOverlapsTheEarlierConsideredIsBetter) {
  CandidateChoice choice(0.1);
  for (const std::uint32_t id : {7U, 3U, 5U}) consider(choice, id, 0.0);
  EXPECT_EQ(ids(choice.best(2)), (std::vector<std::uint32_t>{7, 3}));
}

TEST_F(CandidateChoiceTest, TakesOneInAnyCaseFirst) {
  CandidateChoice choice(0.5);
  consider(choice, 1, 0.0);
  choice.take(4);
  EXPECT_EQ(ids(choice.best(1)), (std::vector<std::uint32_t>{4}));
}

TEST_F(CandidateChoiceTest, SpreadsOverStopsThatAreNotNextToEachOther) {
  CandidateChoice choice(0.0);
  consider(choice, 4, 0.0);  // best
  consider(choice, 5, 0.1);  // next to it
  consider(choice, 3, 0.1);  // on the other side
  consider(choice, 6, 3.0);
  consider(choice, 8, 1.5);
  EXPECT_EQ(ids(choice.best_apart(3)), (std::vector<std::uint32_t>{4, 8, 6}));
  EXPECT_EQ(ids(choice.best_apart(1)), (std::vector<std::uint32_t>{4}));
}

TEST_F(CandidateChoiceTest, AnEmptyOutlineIsNoCandidate) {
  CandidateChoice choice(0.1);
  choice.consider(0, here_.profile, {}, {});
  EXPECT_TRUE(choice.best(3).empty());
}

}  // namespace
}  // namespace topogeo::localization
