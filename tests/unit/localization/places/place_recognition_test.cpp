// A robot drives along a corridor with niches and returns to its beginning with a drifted pose: is
// the place proposed?
#include "topogeo/slam/place_recognition.hpp"

#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/matching/match_features.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

/// Rays in the corridor y = -1 ... 1 whose left wall has niches that are all different.
bool niche(double x_m) {
  return std::fmod(std::fabs(x_m), 3.7) < 0.9 + 0.03 * x_m;
}

/// Niches two metres apart, all equal but the one before 9 m, which is wider.
bool niche_of_many(double x_m) {
  return std::fmod(std::fabs(x_m), 2.0) < 0.7 || (x_m > 8.0 && x_m < 9.0);
}

topomap::LocalMap scan_at(const Pose2& T_world_robot, bool (*has_niche)(double x_m)) {
  const auto left_m = [&](double x_m) { return has_niche(x_m) ? 1.6 : 1.0; };
  topomap::LocalMap map;
  for (int i = 0; i < 360; ++i) {
    const double angle = T_world_robot.theta_rad + i * M_PI / 180.0;
    for (double r = 0.05; r < 12.0; r += 0.02) {
      const double x = T_world_robot.x_m + r * std::cos(angle);
      const double y = T_world_robot.y_m + r * std::sin(angle);
      if (y > -1.0 && y < left_m(x) && x > -2.0 && x < 32.0) continue;
      const Eigen::Vector2d p = geometry::inverse(T_world_robot) * Eigen::Vector2d(x, y);
      map.points.push_back({static_cast<float>(p.x()), static_cast<float>(p.y())});
      break;
    }
  }
  return map;
}

class PlaceRecognitionTest : public testing::Test {
 protected:
  /// Adds a stop with the robot at `truth`, estimated by the graph at `estimate`; `step_sigma` is
  /// the deviation of the step there.
  void stop(const Pose2& truth, const Pose2& estimate, double path_m, double step_sigma = 0.01) {
    const topomap::LocalMap map = scan_at(truth, has_niche_);
    places_.add(std::make_shared<const StopView>(
                    view_of(extract_scan_features(map.points, map.T_robot_laser))),
                path_m);
    graph_.add_pose(estimate);
    if (stops_ > 0) {
      graph_.add_edge({stops_ - 1, stops_, EdgeKind::kOdometry,
                       geometry::between(graph_.poses()[stops_ - 1], estimate),
                       Eigen::Matrix3d::Identity() * step_sigma * step_sigma});
    }
    ++stops_;
  }
  std::vector<PlaceProposal> propose(double sigma_m) {
    const std::uint32_t last = stops_ - 1;
    std::vector<UncertainPose> relative(stops_);
    for (std::uint32_t i = 0; i < stops_; ++i) {
      relative[i].T_a_b = geometry::between(graph_.poses()[last], graph_.poses()[i]);
      relative[i].covariance =
          Eigen::Vector3d(sigma_m * sigma_m, sigma_m * sigma_m, 1e-4).asDiagonal();
    }
    return places_.propose(graph_, last, last - 8, relative, 0.25);
  }

  bool (*has_niche_)(double x_m) = niche;
  PlaceRecognition places_;
  PoseGraph graph_;
  std::uint32_t stops_ = 0;
};

// Out along the corridor to 25 m; from there the robot was carried back to `again_m`, visible only
// in the uncertainty, and drove on.
TEST_F(PlaceRecognitionTest, ProposesTheStretchThatTheRobotIsBackOn) {
  for (int i = 0; i <= 36; ++i) stop({0.7 * i, 0.0, 0.0}, {0.7 * i, 0.0, 0.0}, 0.7 * i);
  const double off_m = 2.0;
  for (int i = 0; i < 9; ++i) {
    const double x_m = 4.0 + 0.7 * i;
    stop({x_m, 0.1, 0.0}, {x_m + off_m, 0.1, 0.0}, 25.9 + 0.7 * i);
  }
  const std::vector<PlaceProposal> found = propose(1.5);
  ASSERT_FALSE(found.empty());
  const PlaceProposal& best = found.front();
  const Pose2 T_world_robot = graph_.poses()[best.anchor] * best.T_anchor_robot;
  EXPECT_NEAR(T_world_robot.x_m, 9.6, 0.15);
  EXPECT_NEAR(T_world_robot.y_m, 0.1, 0.1);
  EXPECT_NEAR(T_world_robot.theta_rad, 0.0, 0.05);
  EXPECT_GT(best.value, 0.88);
  EXPECT_FALSE(best.aligned.covariance.isZero(0.0));
}

// A shift by one niche fits nearly as well; whichever has more in view, the right one is among the
// proposals of the same submap.
TEST_F(PlaceRecognitionTest, ProposesAllPlacesOfASubmapThatLookAlike) {
  has_niche_ = niche_of_many;
  for (int i = 0; i <= 36; ++i) stop({0.7 * i, 0.0, 0.0}, {0.7 * i, 0.0, 0.0}, 0.7 * i);
  for (int i = 0; i < 9; ++i) {
    const double x_m = 4.0 + 0.7 * i;
    stop({x_m, 0.1, 0.0}, {x_m + 1.0, 0.1, 0.0}, 25.9 + 0.7 * i);
  }
  bool right_among_others = false;
  const std::vector<PlaceProposal> found = propose(1.5);
  for (const PlaceProposal& place : found) {
    const Pose2 T_world_robot = graph_.poses()[place.anchor] * place.T_anchor_robot;
    if (std::fabs(T_world_robot.x_m - 9.6) > 0.15) continue;
    for (const PlaceProposal& other : found) {
      const Eigen::Vector2d apart_m =
          other.T_anchor_robot.position_m() - place.T_anchor_robot.position_m();
      right_among_others |= other.anchor == place.anchor && apart_m.norm() > 1.5;
    }
  }
  EXPECT_TRUE(right_among_others);
}

// Views from before a very uncertain step would be found at their old place, whatever the step was.
TEST_F(PlaceRecognitionTest, SearchesWithNothingFromBeforeAStepThatIsHardlyKnown) {
  for (int i = 0; i <= 36; ++i) stop({0.7 * i, 0.0, 0.0}, {0.7 * i, 0.0, 0.0}, 0.7 * i);
  for (int i = 0; i < 9; ++i) {
    const double wrong_m = i < 7 ? 0.0 : 0.8;
    stop({4.0 + 0.7 * i, 0.1, 0.0}, {4.0 + wrong_m + 0.7 * i, 0.1, 0.0}, 25.9 + 0.7 * i,
         i == 7 ? 0.5 : 0.01);
  }
  const std::vector<PlaceProposal> found = propose(1.5);
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found.front().first_of_query, stops_ - 2);
  const Pose2 T_world_robot = graph_.poses()[found.front().anchor] * found.front().T_anchor_robot;
  EXPECT_NEAR(T_world_robot.x_m, 9.6, 0.15);
}

TEST_F(PlaceRecognitionTest, ProposesNothingWhereNoEarlierPlaceCanBe) {
  for (int i = 0; i <= 36; ++i) stop({0.7 * i, 0.0, 0.0}, {0.7 * i, 0.0, 0.0}, 0.7 * i);
  for (int i = 0; i < 9; ++i) {
    stop({4.0 + 0.7 * i, 0.1, 0.0}, {400.0 + 0.7 * i, 0.1, 0.0}, 25.9 + 0.7 * i);
  }
  EXPECT_TRUE(propose(1.5).empty());
}

TEST_F(PlaceRecognitionTest, AsksForNoPlaceThatIsKnownWell) {
  for (int i = 0; i <= 36; ++i) stop({0.7 * i, 0.0, 0.0}, {0.7 * i, 0.0, 0.0}, 0.7 * i);
  for (int i = 0; i < 9; ++i) {
    stop({4.0 + 0.7 * i, 0.1, 0.0}, {4.0 + 0.7 * i, 0.1, 0.0}, 25.9 + 0.7 * i);
  }
  EXPECT_TRUE(propose(0.1).empty());
}

TEST_F(PlaceRecognitionTest, AYoungMapHasNoPlaces) {
  for (int i = 0; i <= 9; ++i) stop({0.7 * i, 0.0, 0.0}, {0.7 * i, 0.0, 0.0}, 0.7 * i);
  EXPECT_TRUE(propose(1.5).empty());
}

}  // namespace
}  // namespace topogeo::localization
