#include "topogeo/fitness/fitness_printed.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

namespace topogeo::localization {
namespace {

using geometry::Pose2;
using geometry::SinCos;

// Chosen where the thesis leaves it open (fitness_printed.hpp); fixed, because the form is only for
// comparison.
constexpr double kEquivalent_m = 0.60;
constexpr double kPrintedClearance_m = 0.30;
constexpr double kEquivalentInclination_rad = std::numbers::pi / 6.0;
constexpr double kNone_m = std::numeric_limits<double>::infinity();

// The angle of an undirected line, from any angle above -3 pi.
double undirected(double angle_rad) {
  while (angle_rad < 0.0) angle_rad += std::numbers::pi;
  while (angle_rad >= std::numbers::pi) angle_rad -= std::numbers::pi;
  return angle_rad;
}

void chord_angles(const std::vector<BranchCurve>& curves, std::vector<double>& angles_rad) {
  angles_rad.clear();
  for (const BranchCurve& curve : curves) {
    const Eigen::Vector2d chord = curve.points_m.back() - curve.points_m.front();
    angles_rad.push_back(undirected(geometry::atan2(chord.y(), chord.x())));
  }
}

// 6.34; infinite if the point does not project between the ends of the branch (def. 6.2.8).
double projected_distance_m(const Eigen::Vector2d& point, const BranchCurve& branch) {
  const Eigen::Vector2d& a = branch.points_m.front();
  const Eigen::Vector2d& b = branch.points_m.back();
  const double along = (point - a).dot(b - a);
  if (!(along >= 0.0 && along <= (b - a).squaredNorm())) return kNone_m;
  double nearest2 = std::numeric_limits<double>::max();
  for (const Eigen::Vector2d& p : branch.points_m) {
    nearest2 = std::min(nearest2, (p - point).squaredNorm());
  }
  return std::sqrt(nearest2);
}

// 6.36, except that two branches along x are parallel.
double orientation_factor(double a_rad, double b_rad) {
  const double sum = a_rad + b_rad;
  return sum > 0.0 ? std::fabs(a_rad - b_rad) / sum : 0.0;
}

}  // namespace

struct PrintedFitness::Pose {
  Pose2 T;
  SinCos r;
  [[nodiscard]] Eigen::Vector2d to_reference(const Eigen::Vector2d& p) const {
    return {T.x_m + r.cos * p.x() - r.sin * p.y(), T.y_m + r.sin * p.x() + r.cos * p.y()};
  }
  [[nodiscard]] Eigen::Vector2d to_query(const Eigen::Vector2d& p) const {
    const double x = p.x() - T.x_m;
    const double y = p.y() - T.y_m;
    return {r.cos * x + r.sin * y, r.cos * y - r.sin * x};
  }
};

struct PrintedFitness::Mean {
  double sum_m = 0.0;
  std::size_t count = 0;
  void add(double distance_m) {
    sum_m += distance_m;
    ++count;
  }
};

void PrintedFitness::bind(const Reference& reference, const MatchFeatures& query) {
  reference_ = reference.features.get();
  query_ = &query;
  chord_angles(reference_->curves, reference_angles_rad_);
  chord_angles(query.curves, query_angles_rad_);
}

double PrintedFitness::at(const Pose2& T_reference_query, const SinCos& heading) const {
  const Pose pose{T_reference_query, heading};
  Mean mean;
  add_nodes(pose, mean);
  add_branches(pose, mean);
  if (mean.count == 0) return 0.0;
  return 1.0 / (mean.sum_m / static_cast<double>(mean.count) + 1.0);  // 6.30 and 6.31
}

void PrintedFitness::add_nodes(const Pose& pose, Mean& mean) const {
  for (const topomap::LocalNode& node : query_->nodes) {
    const Eigen::Vector2d p = pose.to_reference(node.position_m);
    double nearest2 = kEquivalent_m * kEquivalent_m;
    bool found = false;
    for (const topomap::LocalNode& other : reference_->nodes) {
      const double squared = (other.position_m - p).squaredNorm();
      if (squared > nearest2 ||
          std::fabs(other.clearance_m - node.clearance_m) > kPrintedClearance_m) {
        continue;
      }
      nearest2 = squared;
      found = true;
    }
    if (found) mean.add(std::sqrt(nearest2));  // 6.32
  }
}

void PrintedFitness::add_branches(const Pose& pose, Mean& mean) const {
  for (std::size_t i = 0; i < query_->curves.size(); ++i) {
    const double angle_rad = undirected(query_angles_rad_[i] + pose.T.theta_rad);
    Mean equivalent;
    for (std::size_t j = 0; j < reference_->curves.size(); ++j) {
      const BranchCurve& a = query_->curves[i];
      const BranchCurve& b = reference_->curves[j];
      if (std::fabs(a.clearance_m - b.clearance_m) > kPrintedClearance_m) continue;
      const double turn_rad = std::fabs(angle_rad - reference_angles_rad_[j]);
      if (std::min(turn_rad, std::numbers::pi - turn_rad) > kEquivalentInclination_rad) continue;
      const double distance_m = branch_distance_m(pose, a, b);
      if (!(distance_m <= kEquivalent_m)) continue;
      equivalent.add(orientation_factor(angle_rad, reference_angles_rad_[j]) * distance_m);  // 6.37
    }
    if (equivalent.count > 0) {
      mean.add(equivalent.sum_m / static_cast<double>(equivalent.count));
    }
  }
}

// 6.35 for the two projecting points; infinite if fewer than two ends project. If two ends beside
// each other both project, the nearer one counts (Thesis, 6.2.5, proposition 6.2.3).
double PrintedFitness::branch_distance_m(const Pose& pose, const BranchCurve& query,
                                         const BranchCurve& reference) const {
  const Eigen::Vector2d query_a = pose.to_reference(query.points_m.front());
  const Eigen::Vector2d query_b = pose.to_reference(query.points_m.back());
  const Eigen::Vector2d* beside_a = &reference.points_m.front();
  const Eigen::Vector2d* beside_b = &reference.points_m.back();
  if ((query_b - query_a).dot(*beside_b - *beside_a) < 0.0) std::swap(beside_a, beside_b);
  const double d1 = std::min(projected_distance_m(query_a, reference),
                             projected_distance_m(pose.to_query(*beside_a), query));
  const double d2 = std::min(projected_distance_m(query_b, reference),
                             projected_distance_m(pose.to_query(*beside_b), query));
  return std::sqrt(d1 * d1 + d2 * d2) / 2.0;
}

}  // namespace topogeo::localization
