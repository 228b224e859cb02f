// Straight stops 1 m apart. Matches of stops from 30 on with stops from 0 on: those that agree put
// the robot at one place, those of a look-alike at another.
#include "loop/loop_agreement.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace topogeo::localization {
namespace {

using geometry::Pose2;

Eigen::Matrix3d spread_of(double sigma_m, double sigma_rad) {
  return Eigen::Vector3d(sigma_m * sigma_m, sigma_m * sigma_m, sigma_rad * sigma_rad).asDiagonal();
}

class LoopAgreementTest : public testing::Test {
 protected:
  LoopAgreementTest() {
    graph_.add_pose({});
    path_m_.push_back(0.0);
    for (std::uint32_t i = 1; i < 80; ++i) {
      graph_.add_pose({1.0 * i, 0.0, 0.0});
      graph_.add_edge({i - 1, i, EdgeKind::kOdometry, {1.0, 0.0, 0.0}, spread_of(0.02, 0.002)});
      path_m_.push_back(1.0 * i);
    }
  }

  /// A doubtful match that puts the later stop `off_m` to the side of its place.
  static StopMatch match(std::uint32_t from, std::uint32_t to, double off_m) {
    StopMatch match;
    match.edge = {
        from, to, EdgeKind::kRevisit, {1.0 * (to - from), off_m, 0.0}, spread_of(0.02, 0.005)};
    match.reason = Reason::kDoubtful;
    return match;
  }

  void add(std::uint32_t from, std::uint32_t to, double off_m) {
    agreement_.add(match(from, to, off_m), path_m_);
  }
  std::vector<StopMatch> accepted() { return agreement_.accepted(graph_, path_m_); }

  PoseGraph graph_;
  std::vector<double> path_m_;
  LoopAgreement agreement_;
};

TEST_F(LoopAgreementTest, TheWayRoundTwoLoopsMeasuresTheirDisagreement) {
  const PoseGraphEdge a = match(0, 30, 1.0).edge;
  EXPECT_NEAR(disagreement(graph_, a, match(4, 33, 1.0).edge, path_m_, 25.0), 0.0, 1e-9);
  EXPECT_GT(disagreement(graph_, a, match(4, 33, 2.0).edge, path_m_, 25.0), 20.0);
  // Loops whose ends lie far apart cannot be compared.
  EXPECT_EQ(disagreement(graph_, a, match(4, 60, 1.0).edge, path_m_, 25.0),
            std::numeric_limits<double>::infinity());
}

TEST_F(LoopAgreementTest, OneDoubtfulLoopProvesNothing) {
  add(0, 30, 1.0);
  EXPECT_TRUE(accepted().empty());
  EXPECT_EQ(agreement_.waiting(), 1U);
}

TEST_F(LoopAgreementTest, SeveralStopsThatAgreeAreAcceptedTogether) {
  for (std::uint32_t i = 0; i < 2; ++i) add(i, 30 + i, 1.0);
  EXPECT_TRUE(accepted().empty());
  for (std::uint32_t i = 2; i < 6; ++i) add(i, 30 + i, 1.0);
  EXPECT_EQ(accepted().size(), 6U);
  EXPECT_TRUE(accepted().empty());  // each only once
}

TEST_F(LoopAgreementTest, ManyMatchesOfOneStopAreOnePieceOfEvidence) {
  for (std::uint32_t i = 0; i < 8; ++i) add(i, 30, 1.0);
  EXPECT_TRUE(accepted().empty());
}

TEST_F(LoopAgreementTest, TwoPlacesThatLookAlikeAreLeftOpen) {
  for (std::uint32_t i = 0; i < 6; ++i) {
    add(i, 30 + i, 1.0);
    add(i, 29 - i, 3.0);  // another stretch of the same length, see below
  }
  LoopAgreement alike;
  for (std::uint32_t i = 0; i < 6; ++i) {
    alike.add(match(i, 30 + i, 1.0), path_m_);
    alike.add(match(i + 1, 30 + i, -1.5), path_m_);
  }
  EXPECT_TRUE(alike.accepted(graph_, path_m_).empty());
}

// The earlier ends are 35 m of path apart, and the graph knows their relation to decimetres.
TEST_F(LoopAgreementTest, LoopsWithAnotherVisitOfThePlaceAreNoRivals) {
  for (std::uint32_t i = 0; i < 6; ++i) {
    add(i, 70 + i, 1.0);
    add(35 + i, 70 + i, 1.0);
  }
  EXPECT_EQ(accepted().size(), 12U);
}

// Two stops match each of two visits of the place, 35 m of path apart: too few for one visit alone.
TEST_F(LoopAgreementTest, VisitsWhoseRelationIsKnownSpeakTogether) {
  const auto add_visits = [&](LoopAgreement& agreement, double second_off_m) {
    agreement.add(match(0, 70, 1.0), path_m_);
    agreement.add(match(1, 71, 1.0), path_m_);
    agreement.add(match(36, 72, second_off_m), path_m_);
    agreement.add(match(37, 73, second_off_m), path_m_);
  };
  add_visits(agreement_, 1.0);
  EXPECT_EQ(accepted().size(), 4U);

  LoopAgreement contradictory;
  add_visits(contradictory, -1.0);
  EXPECT_TRUE(contradictory.accepted(graph_, path_m_).empty());

  PoseGraph hardly_known;
  hardly_known.add_pose({});
  for (std::uint32_t i = 1; i < 80; ++i) {
    hardly_known.add_pose({1.0 * i, 0.0, 0.0});
    hardly_known.add_edge({i - 1,
                           i,
                           EdgeKind::kOdometry,
                           {1.0, 0.0, 0.0},
                           i == 20 ? spread_of(0.4, 0.002) : spread_of(0.02, 0.002)});
  }
  LoopAgreement open;
  add_visits(open, 1.0);
  EXPECT_TRUE(open.accepted(hardly_known, path_m_).empty());
}

TEST_F(LoopAgreementTest, LoopsWithALookAlikeFarAwayAreRivals) {
  for (std::uint32_t i = 0; i < 6; ++i) {
    add(i, 70 + i, 1.0);
    add(35 + i, 70 + i, -1.5);
  }
  EXPECT_TRUE(accepted().empty());
}

// The robot has drifted by 1.2 m since the first visit, far more than the graph's covariance; its
// most recent matches agree with the graph.
TEST_F(LoopAgreementTest, LoopsThatDriftedAlongAreNoRivals) {
  const auto predicted = [](StopMatch match) {
    match.predicted = {{match.edge.T_from_to.x_m, 0.0, 0.0}, spread_of(0.25, 0.05)};
    return match;
  };
  for (std::uint32_t i = 0; i < 8; ++i) {
    agreement_.add(predicted(match(i, 70 + i, 1.2)), path_m_);
    if (i < 4) agreement_.add(predicted(match(35 + i, 70 + i, 0.0)), path_m_);
  }
  const std::vector<StopMatch> all = accepted();
  EXPECT_EQ(std::count_if(all.begin(), all.end(),
                          [](const StopMatch& one) { return one.edge.from < 20; }),
            8);
}

// Three stops of a sparse log are as much evidence as five of a dense one.
TEST_F(LoopAgreementTest, StopsFarApartCountMore) {
  LoopAgreement dense;
  std::vector<double> half_m = path_m_;
  for (double& at_m : half_m) at_m *= 0.5;
  for (std::uint32_t i = 0; i < 3; ++i) {
    add(i, 30 + i, 1.0);
    dense.add(match(i, 30 + i, 1.0), half_m);
  }
  EXPECT_EQ(accepted().size(), 3U);
  EXPECT_TRUE(dense.accepted(graph_, half_m).empty());
}

TEST_F(LoopAgreementTest, AFewThatContradictAreOutvoted) {
  add(2, 31, -1.5);
  for (std::uint32_t i = 0; i < 7; ++i) add(i, 30 + i, 1.0);
  const std::vector<StopMatch> all = accepted();
  EXPECT_EQ(all.size(), 7U);
  for (const StopMatch& one : all) EXPECT_EQ(one.edge.T_from_to.y_m, 1.0);
  EXPECT_EQ(agreement_.waiting(), 7U);  // the accepted ones remain as support, the other is removed
  EXPECT_GE(all.front().agreement, 2.0 * all.front().rival_agreement);
  EXPECT_EQ(all.front().rival_agreement, 1.0);  // one doubtful match
}

// Half a metre off a prediction that all others agree with.
TEST_F(LoopAgreementTest, WhatAloneContradictsThePredictionIsLeftOut) {
  const auto predicted = [](StopMatch match, double off_m) {
    match.predicted = {{match.edge.T_from_to.x_m, match.edge.T_from_to.y_m - off_m, 0.0},
                       spread_of(0.1, 0.05)};
    return match;
  };
  for (std::uint32_t i = 0; i < 6; ++i) {
    agreement_.add(predicted(match(i, 30 + i, 1.0), 0.1), path_m_);
  }
  agreement_.add(predicted(match(6, 36, 1.0), 0.5), path_m_);
  const std::vector<StopMatch> all = accepted();
  EXPECT_EQ(all.size(), 6U);
  for (const StopMatch& one : all) EXPECT_NE(one.edge.from, 6U);
}

// 0.35 m off, which the prediction does not exclude: its inliers decide.
TEST_F(LoopAgreementTest, WhatIsImprobableAmongOthersIsLeftOut) {
  for (const double inliers : {0.0, 0.9}) {
    LoopAgreement agreement;
    for (std::uint32_t i = 0; i < 7; ++i) {
      StopMatch one = match(i, 30 + i, 1.0);
      one.predicted = {{30.0, i == 6 ? 0.65 : 1.0, 0.0}, spread_of(0.14, 0.05)};
      one.inliers = i == 6 ? inliers : 0.9;
      agreement.add(one, path_m_);
    }
    EXPECT_EQ(agreement.accepted(graph_, path_m_).size(), inliers > 0.0 ? 7U : 6U);
  }
}

// At a place where the robot is expected, matches of stops are more accurate than windows.
TEST_F(LoopAgreementTest, WindowsAreTakenOnlyWhereTheySurprise) {
  for (const bool surprising : {false, true}) {
    LoopAgreement agreement;
    for (std::uint32_t i = 0; i < 12; ++i) {
      StopMatch one = match(i, 30 + i, 1.0);
      one.predicted = {{30.0, surprising ? 0.0 : 1.0, 0.0}, spread_of(0.2, 0.02)};
      if (i % 2 == 1) {
        one.source = ProposalSource::kWindow;
        one.first_of_window = 25 + i;
      }
      agreement.add(one, path_m_);
    }
    EXPECT_EQ(agreement.accepted(graph_, path_m_).size(), surprising ? 12U : 6U);
  }
}

// Windows of 5 m that end 1 m apart are nearly the same; five of them span no more than 9 m.
TEST_F(LoopAgreementTest, WindowsCountByThePathThatNoOtherHolds) {
  const auto windows = [&](std::uint32_t first, std::uint32_t count, std::uint32_t apart) {
    LoopAgreement agreement;
    for (std::uint32_t i = 0; i < count; ++i) {
      StopMatch window = match(apart * i, first + apart * i, 1.0);
      window.source = ProposalSource::kWindow;
      window.first_of_window = window.edge.to - 5;
      window.predicted = {{1.0 * first, 0.0, 0.0}, spread_of(0.25, 0.02)};
      agreement.add(window, path_m_);
    }
    return agreement.accepted(graph_, path_m_).size();
  };
  EXPECT_EQ(windows(30, 7, 1), 0U);
  EXPECT_EQ(windows(30, 4, 5), 4U);    // 20 m without overlap
  EXPECT_EQ(windows(30, 16, 1), 16U);  // the same 20 m
}

TEST_F(LoopAgreementTest, AgainstAGoodPredictionMoreAreWanted) {
  const auto surprising = [&](std::uint32_t i) {
    StopMatch one = match(i, 30 + i, 1.0);
    one.predicted = {{30.0, 0.0, 0.0}, spread_of(0.2, 0.02)};
    return one;
  };
  for (std::uint32_t i = 0; i < 4; ++i) agreement_.add(surprising(i), path_m_);
  EXPECT_TRUE(accepted().empty());
  for (std::uint32_t i = 4; i < 10; ++i) agreement_.add(surprising(i), path_m_);
  EXPECT_EQ(accepted().size(), 10U);
}

TEST_F(LoopAgreementTest, AcceptedLoopsSpeakForOthersAndAreNotReturned) {
  for (std::uint32_t i = 0; i < 3; ++i) agreement_.add_accepted(match(i, 30 + i, 1.0), path_m_);
  EXPECT_TRUE(accepted().empty());
  add(3, 33, 1.0);
  const std::vector<StopMatch> all = accepted();
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(all[0].edge.to, 33U);
}

}  // namespace
}  // namespace topogeo::localization
