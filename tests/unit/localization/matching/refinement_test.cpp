#include "topogeo/matching/refinement.hpp"

#include <cmath>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "fitness_combined.hpp"
#include "localization/hand_scenes.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;
using test::kDegree;

PosePrior no_prior() {
  return {};
}

TEST(RefinementTest, FindsAKnownOffsetInARoom) {
  const Reference reference = make_reference(test::features_at(test::l_room(), {}));
  const Pose2 truth{0.4, -0.3, 0.3};
  const MatchFeatures query = test::features_at(test::l_room(), truth);
  for (const Pose2& offset :
       {Pose2{0.1, -0.08, 0.05}, Pose2{-0.12, 0.05, -0.06}, Pose2{0, 0, 0.1}, Pose2{0.15, 0, 0}}) {
    const Refinement found =
        refine(reference, query,
               {truth.x_m + offset.x_m, truth.y_m + offset.y_m, truth.theta_rad + offset.theta_rad},
               no_prior());
    EXPECT_TRUE(found.converged);
    EXPECT_LT(test::distance_m(found.T_reference_query, truth), 0.01);
    EXPECT_LT(test::turn_rad(found.T_reference_query, truth), 0.2 * kDegree);
    EXPECT_GT(found.overlap, 0.9);
    EXPECT_GT(found.inliers, 0.97);
    EXPECT_LT(found.violations, 0.03);
    EXPECT_LT(found.residual_rms_m, 0.02);
  }
}

TEST(RefinementTest, AShutDoorTellsWhereInACorridor) {
  const Reference reference =
      make_reference(test::features_at(test::corridor_with_shut_door(), {}));
  const Pose2 truth{0.5, 0.1, 0.1};
  const MatchFeatures query = test::features_at(test::corridor_with_shut_door(), truth);
  for (const double off_m : {-0.15, 0.12}) {
    const Refinement found = refine(reference, query, {truth.x_m + off_m, 0.05, 0.08}, no_prior());
    EXPECT_TRUE(found.converged);
    EXPECT_NEAR(found.T_reference_query.x_m, truth.x_m, 0.02);
    EXPECT_NEAR(found.T_reference_query.y_m, truth.y_m, 0.01);
    // Known to a decimetre, less well than the direction across.
    EXPECT_LT(1.0 / std::sqrt(found.information(0, 0)), 0.12);
    EXPECT_LT(found.information(0, 0), 0.1 * found.information(1, 1));
  }
}

TEST(RefinementTest, AlongABareCorridorThePriorStands) {
  const Reference reference = make_reference(test::features_at(test::endless_corridor(), {}));
  const MatchFeatures query = test::features_at(test::endless_corridor(), {0.5, 0.1, 0.1});
  PosePrior prior{{0.3, 0.0, 0.05}, Eigen::Matrix3d::Zero()};
  prior.information.diagonal() << 100.0, 100.0, 400.0;
  const Refinement found = refine(reference, query, prior.T_reference_query, prior);
  EXPECT_TRUE(found.converged);
  EXPECT_NEAR(found.T_reference_query.x_m, 0.3, 0.01);  // the prior, not the truth at 0.5
  EXPECT_NEAR(found.T_reference_query.y_m, 0.1, 0.01);
  EXPECT_NEAR(found.T_reference_query.theta_rad, 0.1, 0.2 * kDegree);
  // The evidence agrees: the direction across is known a thousand times better than along.
  EXPECT_LT(found.information(0, 0), 1e-3 * found.information(1, 1));

  const Refinement free = refine(reference, query, {0.3, 0.0, 0.05}, no_prior());
  EXPECT_NEAR(free.T_reference_query.x_m, 0.3, 0.02);
  EXPECT_NEAR(free.T_reference_query.y_m, 0.1, 0.01);
}

// A rack of 0.4 m across the hall, seen from both of its ends: its two long faces, and the walls at
// the sides. If the faces were aligned, the robot would be 0.4 m off.
TEST(RefinementTest, TheTwoFacesOfARackAreNotLaidOnEachOther) {
  const world::World hall = test::lines({{{-8, -3}, {8, -3}},
                                         {{-8, 3}, {8, 3}},
                                         {{-0.2, -1}, {-0.2, 1}},
                                         {{0.2, -1}, {0.2, 1}},
                                         {{-0.2, -1}, {0.2, -1}},
                                         {{-0.2, 1}, {0.2, 1}}});
  const Pose2 T_world_reference{-4.0, 0.0, 0.0};
  const Pose2 T_world_query{4.0, 0.2, 180.0 * kDegree};
  const test::Sweep ahead{-50.0, 50.0, 0.5, 8.0};
  const Reference reference = make_reference(test::features_at(hall, T_world_reference, ahead));
  const MatchFeatures query = test::features_at(hall, T_world_query, ahead);
  const Pose2 truth = geometry::between(T_world_reference, T_world_query);
  const Pose2 laid_on_each_other{truth.x_m - 0.4, truth.y_m, truth.theta_rad};
  const Eigen::Matrix3d weak = Eigen::Matrix3d::Identity();
  const Refinement wrong = refine(reference, query, laid_on_each_other, {laid_on_each_other, weak});
  const Refinement right = refine(reference, query, truth, {truth, weak});
  // The position along the hall is unknown: neither pose attracts, and no face counts as shared.
  EXPECT_LT(wrong.information(0, 0), 0.02 * wrong.information(1, 1));
  EXPECT_LT(right.information(0, 0), 0.02 * right.information(1, 1));
  EXPECT_LT(test::distance_m(right.T_reference_query, truth), 0.05);
  EXPECT_LT(wrong.overlap, right.overlap + 0.01);
  const ScanFitness fitness(reference, query);
  EXPECT_LT(fitness(laid_on_each_other), fitness(truth) + 0.02);
}

TEST(RefinementTest, AStrongPriorHoldsThePose) {
  const Reference reference = make_reference(test::features_at(test::l_room(), {}));
  const MatchFeatures query = test::features_at(test::l_room(), {0.1, 0.0, 0.0});
  PosePrior prior{{}, Eigen::Matrix3d::Identity() * 1e9};
  EXPECT_LT(test::distance_m(refine(reference, query, {}, prior).T_reference_query, {}), 1e-3);
}

TEST(RefinementTest, TooFewPointsAreNoEvidence) {
  const Reference reference = make_reference(test::features_at(test::l_room(), {}));
  const MatchFeatures few = test::features_at(test::l_room(), {}, {-40, 40, 10, 8});
  ASSERT_GT(few.surface.size(), 5U);
  ASSERT_LT(few.surface.size(), 12U);
  const Pose2 guess{0.03, 0.02, 0.01};
  const Refinement found = refine(reference, few, guess, no_prior());
  EXPECT_FALSE(found.converged);
  EXPECT_EQ(found.T_reference_query, guess);
  EXPECT_TRUE(found.information.isZero());
}

TEST(RefinementTest, NothingInViewLeavesThePoseAndSaysSo) {
  const MatchFeatures room = test::features_at(test::l_room(), {});
  const Reference reference = make_reference(room);
  const Refinement away = refine(reference, room, {200.0, 0.0, 0.0}, no_prior());
  EXPECT_FALSE(away.converged);
  EXPECT_EQ(away.T_reference_query, (Pose2{200.0, 0.0, 0.0}));
  EXPECT_EQ(away.overlap, 0.0);
  const MatchFeatures nothing;
  EXPECT_EQ(refine(reference, nothing, {}, no_prior()).overlap, 0.0);
  EXPECT_FALSE(refine(make_reference({}), room, {}, no_prior()).converged);
}

// A wall of the reference in the query's free space, and the reverse.
TEST(RefinementTest, SeesWallsWhereTheOtherMapSawFreeSpace) {
  world::World with_wall = test::l_room();
  with_wall.segments.push_back({{-1.0, 0.8}, {1.0, 0.8}});
  const MatchFeatures open = test::features_at(test::l_room(), {});
  const MatchFeatures divided = test::features_at(with_wall, {});
  EXPECT_GT(refine(make_reference(open), divided, {}, no_prior()).violations, 0.1);
  EXPECT_GT(refine(make_reference(divided), open, {}, no_prior()).violations, 0.1);
  EXPECT_LT(refine(make_reference(open), open, {}, no_prior()).violations, 0.01);
}

// Point-to-line residual of every query point that the refinement uses near a good pose, by the
// public look-up.
std::vector<double> residuals(const Reference& reference, const MatchFeatures& query,
                              const Pose2& T_association, const Pose2& T) {
  std::vector<double> out;
  for (const SurfacePoint& point : query.surface) {
    const Eigen::Vector2d at = T_association * point.position_m;
    const std::int32_t found = reference.surface_grid.find(at.x(), at.y());
    if (found == NearestPointGrid::kNone) continue;
    const SurfacePoint& other = reference.features->surface[static_cast<std::size_t>(found)];
    if (!other.on_line || (at - other.position_m).norm() > 0.2) continue;
    const Pose2 only_turn{0.0, 0.0, T_association.theta_rad};
    const double cosine = (only_turn * point.normal).dot(other.normal);
    if (point.on_line && cosine < std::sqrt(0.5)) continue;
    out.push_back(other.normal.dot(T * point.position_m - other.position_m));
  }
  return out;
}

TEST(RefinementTest, TakesThePullOfThePriorOutAgain) {
  // Scans with optimum z, a prior with optimum p: they balance at H (T - z) + P (T - p) = 0.
  Eigen::Matrix3d H;
  H << 900, 40, -15, 40, 400, 30, -15, 30, 2500;
  const Eigen::Matrix3d P = Eigen::Vector3d(200, 300, 800).asDiagonal();
  const Eigen::Vector3d z(1.00, 2.00, 0.300);
  const Eigen::Vector3d p(1.12, 1.91, 0.328);
  const Eigen::Vector3d T = (H + P).inverse() * (H * z + P * p);
  const Pose2 found = without_prior({T.x(), T.y(), T.z()}, H.inverse(), {{p.x(), p.y(), p.z()}, P});
  EXPECT_NEAR(found.x_m, z.x(), 1e-12);
  EXPECT_NEAR(found.y_m, z.y(), 1e-12);
  EXPECT_NEAR(found.theta_rad, z.z(), 1e-12);
}

TEST(RefinementTest, TakesTheWholePriorInsteadOfTheWeakOne) {
  Eigen::Matrix3d H;
  H << 900, 40, -15, 40, 400, 30, -15, 30, 2500;
  const PosePrior prior{{1.12, 1.91, 0.328}, Eigen::Vector3d(200, 300, 800).asDiagonal()};
  const Eigen::Vector3d p(1.12, 1.91, 0.328);
  const Eigen::Vector3d z(1.00, 2.00, 0.300);
  const Eigen::Matrix3d W = weak_prior(prior).information;
  EXPECT_TRUE(W.isApprox(0.1 * prior.information));
  EXPECT_EQ(weak_prior(prior).T_reference_query, prior.T_reference_query);
  const Eigen::Vector3d weak = (H + W).inverse() * (H * z + W * p);
  const Eigen::Vector3d whole = (H + prior.information).inverse() * (H * z + prior.information * p);
  const Pose2 found = with_prior({weak.x(), weak.y(), weak.z()}, H.inverse(), prior);
  EXPECT_NEAR(found.x_m, whole.x(), 1e-12);
  EXPECT_NEAR(found.y_m, whole.y(), 1e-12);
  EXPECT_NEAR(found.theta_rad, whole.z(), 1e-12);
}

TEST(RefinementTest, WithoutPriorComesBackToWhatTheScansSay) {
  const Reference reference = make_reference(test::features_at(test::l_room(), {}));
  const Pose2 truth{0.4, -0.3, 0.3};
  const MatchFeatures query = test::features_at(test::l_room(), truth);
  const PosePrior prior{{0.45, -0.26, 0.31}, Eigen::Vector3d(4e3, 4e3, 4e4).asDiagonal()};
  const Refinement pulled = refine(reference, query, prior.T_reference_query, prior);
  const Pose2 scans = without_prior(pulled.T_reference_query, pulled.information.inverse(), prior);
  EXPECT_GT(test::distance_m(pulled.T_reference_query, truth), 0.005);
  EXPECT_LT(test::distance_m(scans, truth),
            0.5 * test::distance_m(pulled.T_reference_query, truth));
}

// Along a corridor the scans contain almost no information: their optimum there must not count.
TEST(RefinementTest, WithoutPriorStaysAlongWhatTheScansHardlyKnow) {
  // In a corridor that runs at 30 degrees the scans know the position along to 1 m, across to 2 cm.
  const double angle = 30.0 * kDegree;
  const Eigen::Vector3d along(std::cos(angle), std::sin(angle), 0.0);
  const Eigen::Vector3d across(-std::sin(angle), std::cos(angle), 0.0);
  Eigen::Matrix3d covariance = along * along.transpose() + 4e-4 * across * across.transpose();
  covariance(2, 2) = 1e-4;
  PosePrior prior{{}, Eigen::Matrix3d::Identity() * 400.0};
  prior.information(2, 2) = 1e4;
  const Eigen::Vector3d shift = 5e-4 * along + 0.02 * across;
  const Pose2 free = without_prior({shift.x(), shift.y(), 0.0}, covariance, prior);
  const Eigen::Vector3d step = Eigen::Vector3d(free.x_m, free.y_m, 0.0) - shift;
  EXPECT_NEAR(step.dot(along), 0.0, 1e-9);
  EXPECT_NEAR(step.dot(across), 4e-4 * 400.0 * 0.02, 1e-9);
}

TEST(RefinementTest, WithoutPriorDoesNotGoFar) {
  const PosePrior prior{{0.2, 0.0, 0.0}, Eigen::Vector3d(100, 100, 100).asDiagonal()};
  const Pose2 aligned{0.1, 0.0, 0.0};
  const Eigen::Matrix3d covariance = Eigen::Vector3d(0.1, 1e-4, 1e-5).asDiagonal();
  EXPECT_EQ(without_prior(aligned, covariance, prior), aligned);
}

// The Hessian of the data term against numeric derivatives of the residuals: in a noiseless scene
// all weights are 1 / sigma^2 at the optimum.
TEST(RefinementTest, InformationIsThatOfNumericDerivatives) {
  const Reference reference = make_reference(test::features_at(test::l_room(), {}));
  const Pose2 truth{0.3, 0.2, 0.15};
  const MatchFeatures query = test::features_at(test::l_room(), truth);
  const Refinement found = refine(reference, query, truth, no_prior());
  ASSERT_TRUE(found.converged);
  const Pose2 T = found.T_reference_query;
  constexpr double kStep = 1e-5;
  constexpr double kSigma_m = 0.08;
  constexpr double kCauchy_m = 0.05;
  const auto at = [&](double x, double y, double theta) {
    return residuals(reference, query, T, {T.x_m + x, T.y_m + y, T.theta_rad + theta});
  };
  const auto centre = at(0, 0, 0);
  const auto x_up = at(kStep, 0, 0);
  const auto x_down = at(-kStep, 0, 0);
  const auto y_up = at(0, kStep, 0);
  const auto y_down = at(0, -kStep, 0);
  const auto t_up = at(0, 0, kStep);
  const auto t_down = at(0, 0, -kStep);
  ASSERT_GT(centre.size(), 100U);
  Eigen::Matrix3d numeric = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < centre.size(); ++i) {
    const Eigen::Vector3d row =
        Eigen::Vector3d(x_up[i] - x_down[i], y_up[i] - y_down[i], t_up[i] - t_down[i]) /
        (2.0 * kStep);
    const double u = centre[i] / kCauchy_m;
    numeric += row * row.transpose() / (kSigma_m * kSigma_m * (1.0 + u * u));
  }
  EXPECT_TRUE(found.information.isApprox(numeric, 0.02)) << found.information << "\n\n" << numeric;
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(found.information).eigenvalues()(0),
            0.0);
}

}  // namespace
}  // namespace topogeo::localization
