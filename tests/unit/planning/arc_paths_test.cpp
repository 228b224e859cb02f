#include "arc_paths.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "topogeo/support/random.hpp"

namespace topogeo::planning {
namespace {

constexpr double kPi = std::numbers::pi;

geometry::Pose2 end_of(const geometry::Pose2& from, const ArcPath& path) {
  geometry::Pose2 pose = from;
  for (const ArcPiece& piece : path) pose = after(pose, piece);
  return pose;
}

double length_of_path_m(const ArcPath& path) {
  double sum = 0.0;
  for (const ArcPiece& piece : path) sum += std::fabs(piece.length_m);
  return sum;
}

TEST(ArcPaths, APieceEndsWhereItsCircleDoes) {
  const geometry::Pose2 left = after({1.0, 2.0, 0.0}, {0.5 * kPi, 1.0});
  EXPECT_NEAR(left.x_m, 2.0, 1e-12);
  EXPECT_NEAR(left.y_m, 3.0, 1e-12);
  EXPECT_NEAR(left.theta_rad, 0.5 * kPi, 1e-12);
  const geometry::Pose2 back = after({1.0, 2.0, 0.0}, {-0.5 * kPi, 1.0});
  EXPECT_NEAR(back.x_m, 0.0, 1e-12);
  EXPECT_NEAR(back.y_m, 3.0, 1e-12);
  EXPECT_NEAR(back.theta_rad, -0.5 * kPi, 1e-12);
}

TEST(ArcPaths, HandWorkedLengths) {
  // Straight ahead, straight back, and a half circle.
  EXPECT_NEAR(shortest_arcs_m({}, {3.0, 0.0, 0.0}, 0.8), 3.0, 1e-9);
  EXPECT_NEAR(shortest_arcs_m({}, {-3.0, 0.0, 0.0}, 0.8), 3.0, 1e-9);
  EXPECT_NEAR(shortest_arcs_m({}, {0.0, 1.6, kPi}, 0.8), 0.8 * kPi, 1e-9);
  // The half turn in three points at one place: three arcs of 60 degrees.
  EXPECT_NEAR(shortest_arcs_m({}, {0.0, 0.0, kPi}, 0.8), 0.8 * kPi, 1e-9);
}

TEST(ArcPaths, EveryWordLeadsToTheGoalWithinTheRadius) {
  support::Random random(7);
  for (int run = 0; run < 2000; ++run) {
    const auto draw = [&] {
      return geometry::Pose2{random.uniform(-3.0, 3.0), random.uniform(-3.0, 3.0),
                             random.uniform(-kPi, kPi)};
    };
    const geometry::Pose2 from = draw();
    const geometry::Pose2 to = draw();
    const double radius_m = random.uniform(0.3, 2.0);
    const std::vector<ArcPath> paths = arc_paths(from, to, radius_m);
    ASSERT_FALSE(paths.empty()) << run;
    double least_m = 1e9;
    for (const ArcPath& path : paths) {
      const geometry::Pose2 end = end_of(from, path);
      EXPECT_NEAR(end.x_m, to.x_m, 1e-4) << run;
      EXPECT_NEAR(end.y_m, to.y_m, 1e-4) << run;
      EXPECT_NEAR(geometry::wrap_angle(end.theta_rad - to.theta_rad), 0.0, 1e-4) << run;
      least_m = std::min(least_m, length_of_path_m(path));
      for (const ArcPiece& piece : path) {
        EXPECT_LE(std::fabs(piece.curvature_per_m), 1.0 / radius_m + 1e-12);
      }
    }
    const double shortest_m = shortest_arcs_m(from, to, radius_m);
    EXPECT_NEAR(shortest_m, least_m, 1e-4) << run;
    EXPECT_GE(shortest_m, (to.position_m() - from.position_m()).norm() - 1e-9) << run;
    EXPECT_NEAR(shortest_m, shortest_arcs_m(to, from, radius_m), 1e-6) << "the way back, " << run;
  }
}

// No sequence of short pieces is shorter than the shortest word by more than its step.
TEST(ArcPaths, NoRandomDriveIsShorter) {
  support::Random random(11);
  for (int run = 0; run < 3000; ++run) {
    geometry::Pose2 pose;
    double driven_m = 0.0;
    const int pieces = 1 + static_cast<int>(random.below(5));
    for (int i = 0; i < pieces; ++i) {
      const double side = static_cast<double>(random.below(3)) - 1.0;
      const ArcPiece piece{random.uniform(-2.0, 2.0), side / 0.8};
      pose = after(pose, piece);
      driven_m += std::fabs(piece.length_m);
    }
    EXPECT_LE(shortest_arcs_m({}, pose, 0.8), driven_m + 1e-6) << run;
  }
}

}  // namespace
}  // namespace topogeo::planning
