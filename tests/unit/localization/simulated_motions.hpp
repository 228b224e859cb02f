// Motions of a robot by odometry and by a laser, with known, simulated noise.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/Cholesky>

#include "topogeo/calibration/odometry_calibration.hpp"
#include "topogeo/support/random.hpp"

namespace topogeo::localization::test {

using geometry::Pose2;

// Translation along, by turn, lateral; heading by distance, by turn: the order of the struct.
inline constexpr OdometryNoise kTrue{0.002, 0.003, 0.0008, 0.0003, 0.001};
inline constexpr OdometryNoise kFallback{0.11, 0.12, 0.13, 0.14, 0.15};

/// Parameters of a drive.
struct Drive {
  OdometryNoise noise = kTrue;
  std::uint32_t stops = 300;
  double path_m = 0.35;  // of a step, three to a stretch
  double turn_rad =
      0.5;  // deviation of the turn of a step; a random half of the stretches is straight
  double stated_over_true = 1.0;  // deviations of the measurements
  double outlying = 0.0;          // share of measurements that are wrong by about a metre
  double too_long = 0.0;          // systematic errors
  double left_rad_per_m = 0.0;
  double turn_too_much = 0.0;
  geometry::Pose2 T_robot_laser;
  geometry::Pose2 T_robot_assumed;  // mounting assumed when the laser's motions were measured
  bool exact = false;  // the measurements have no error, whatever covariance they state
};

struct Motions {
  std::vector<OdometryStretch> stretches;
  std::vector<MeasuredMotion> motions;
};

inline Eigen::Vector3d draw(support::Random& random, const Eigen::Matrix3d& covariance) {
  const Eigen::Vector3d normal(random.normal(), random.normal(), random.normal());
  // LDLT, because parts of the covariance may be zero.
  const Eigen::LDLT<Eigen::Matrix3d> root(covariance);
  const Eigen::Vector3d scaled = root.vectorD().cwiseMax(0.0).cwiseSqrt().cwiseProduct(normal);
  return root.transpositionsP().transpose() * (root.matrixL() * scaled);
}

inline Pose2 moved(const Pose2& pose, const Eigen::Vector3d& by) {
  return {pose.x_m + by.x(), pose.y_m + by.y(), geometry::wrap_angle(pose.theta_rad + by.z())};
}

/// The true motion for an odometry step of `step`.
inline Pose2 true_step(support::Random& random, const Drive& drive, const Pose2& step) {
  const double path_m = std::sqrt(step.position_m().squaredNorm());
  const Pose2 random_part = moved(step, draw(random, advance({}, step, drive.noise).covariance));
  return {
      random_part.x_m / (1.0 + drive.too_long), random_part.y_m / (1.0 + drive.too_long),
      random_part.theta_rad - drive.left_rad_per_m * path_m - drive.turn_too_much * step.theta_rad};
}

inline Motions simulate(const Drive& drive, std::uint64_t seed) {
  support::Random random(seed);
  Motions made;
  std::vector<Pose2> T_world_robot(1);
  for (std::uint32_t stop = 1; stop < drive.stops; ++stop) {
    OdometryStretch stretch;
    Pose2 T = T_world_robot.back();
    const double turn_rad = random.below(2) == 0 ? drive.turn_rad : 0.0;
    for (int i = 0; i < 3; ++i) {
      stretch.push_back({drive.path_m, 0.0, turn_rad * random.normal()});
      T = T * true_step(random, drive, stretch.back());
    }
    made.stretches.push_back(stretch);
    T_world_robot.push_back(T);
  }
  const Eigen::Vector3d deviation(0.02, 0.02, 0.01);
  const Eigen::Matrix3d covariance = deviation.cwiseAbs2().asDiagonal();
  for (std::uint32_t first = 0; first < drive.stops; ++first) {
    for (const std::uint32_t span : {1U, 2U, 4U}) {
      if (first + span >= drive.stops) continue;
      const Pose2 T = geometry::between(T_world_robot[first] * drive.T_robot_laser,
                                        T_world_robot[first + span] * drive.T_robot_laser);
      Eigen::Vector3d error = Eigen::Vector3d::Zero();
      if (!drive.exact) error = draw(random, covariance);
      if (random.uniform() < drive.outlying) error += Eigen::Vector3d(1.0, -0.8, 0.5);
      const double factor = drive.stated_over_true * drive.stated_over_true;
      made.motions.push_back(
          {first, first + span,
           moved(drive.T_robot_assumed * T * geometry::inverse(drive.T_robot_assumed), error),
           factor * covariance});
    }
  }
  return made;
}

}  // namespace topogeo::localization::test
