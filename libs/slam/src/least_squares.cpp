#include "least_squares.hpp"

#include <array>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <ceres/ceres.h>

#include "topogeo/geometry/portable_math.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

// A factorization fills up where places were passed many times: it takes gigabytes for 20 km in one
// building. So large a problem was already solved in parts and is near its solution, where
// conjugate gradients reach the same cost with memory proportional to the edges.
constexpr std::size_t kMostFactored = 6000;
constexpr int kMostGradients = 1000;

// Whitened difference between the relative pose of two stops and the measurement of an edge.
class RelativePoseCost : public ceres::SizedCostFunction<3, 3, 3> {
 public:
  explicit RelativePoseCost(const PoseGraphEdge& edge)
      : measured_(edge.T_from_to),
        root_information_(edge.covariance.inverse().llt().matrixL().transpose()) {}

  bool Evaluate(double const* const* poses, double* residuals, double** jacobians) const override {
    const double* a = poses[0];
    const double* b = poses[1];
    const geometry::SinCos r = geometry::sincos(a[2]);
    const double dx = b[0] - a[0];
    const double dy = b[1] - a[1];
    const Eigen::Vector3d error(r.cos * dx + r.sin * dy - measured_.x_m,
                                -r.sin * dx + r.cos * dy - measured_.y_m,
                                geometry::wrap_angle(b[2] - a[2] - measured_.theta_rad));
    Eigen::Map<Eigen::Vector3d>{residuals} = root_information_ * error;
    if (jacobians == nullptr) return true;
    using Jacobian = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
    if (jacobians[0] != nullptr) {
      Eigen::Matrix3d j;
      j << -r.cos, -r.sin, -r.sin * dx + r.cos * dy,  //
          r.sin, -r.cos, -r.cos * dx - r.sin * dy,    //
          0.0, 0.0, -1.0;
      Eigen::Map<Jacobian>{jacobians[0]} = root_information_ * j;
    }
    if (jacobians[1] != nullptr) {
      Eigen::Matrix3d j;
      j << r.cos, r.sin, 0.0, -r.sin, r.cos, 0.0, 0.0, 0.0, 1.0;
      Eigen::Map<Jacobian>{jacobians[1]} = root_information_ * j;
    }
    return true;
  }

 private:
  Pose2 measured_;
  Eigen::Matrix3d root_information_;
};

}  // namespace

OptimizationSummary least_squares(std::span<Pose2> poses, std::span<const std::uint8_t> held,
                                  std::span<const PoseGraphEdge> edges) {
  if (poses.size() < 2 || edges.empty()) return {true, true, 0.0, 0.0, 0};
  std::vector<std::array<double, 3>> values;
  values.reserve(poses.size());
  for (const Pose2& pose : poses) values.push_back({pose.x_m, pose.y_m, pose.theta_rad});

  ceres::Problem problem;
  for (const PoseGraphEdge& edge : edges) {
    ceres::LossFunction* loss = nullptr;
    if (edge.kind == EdgeKind::kSequential) loss = new ceres::CauchyLoss(3.0);
    if (edge.kind == EdgeKind::kRevisit) loss = new ceres::CauchyLoss(2.0);
    problem.AddResidualBlock(new RelativePoseCost(edge), loss, values[edge.from].data(),
                             values[edge.to].data());
  }
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (held[i] != 0 && problem.HasParameterBlock(values[i].data())) {
      problem.SetParameterBlockConstant(values[i].data());
    }
  }

  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  // Eigen's Cholesky instead of SuiteSparse's, whose BLAS kernels depend on the CPU.
  options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  if (poses.size() > kMostFactored) {
    options.linear_solver_type = ceres::CGNR;
    options.preconditioner_type = ceres::JACOBI;
    options.max_linear_solver_iterations = kMostGradients;
  }
  options.num_threads = 1;
  options.max_num_iterations = 30;
  options.function_tolerance = 1e-5;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);

  for (std::size_t i = 0; summary.IsSolutionUsable() && i < poses.size(); ++i) {
    poses[i] = {values[i][0], values[i][1], geometry::wrap_angle(values[i][2])};
  }
  return {summary.IsSolutionUsable(), summary.termination_type == ceres::CONVERGENCE,
          summary.initial_cost, summary.final_cost, static_cast<int>(summary.iterations.size())};
}

}  // namespace topogeo::localization
