#include "topogeo/localization/matching/branch_refinement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "topogeo/geometry/portable_math.hpp"

#include "least_squares_steps.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;
using topomap::LocalNode;
using topomap::NodeKind;

// Fixed: matches depend on them and tasks do not carry them. The deviations are two to four times
// the distance at which an element is found again (tests/bench/repeatability.sh), as neighbouring
// samples come of the same readings.
constexpr std::size_t kFewestElements = 5;
constexpr ShrinkingGate kBranchGate{0.50, 0.25, 0.05};
constexpr double kAcrossSigma_m = 0.06;
constexpr double kClearanceSigma_m = 0.10;
constexpr double kNodeSigma_m = 0.12;
constexpr double kBranchCauchy_m = 0.06;
constexpr double kNodeCauchy_m = 0.15;
constexpr double kSameDirection = 0.9;  // cosine between two branches that may be one
constexpr double kSameClearance_m = 0.35;
constexpr double kLeastSlope = 0.15;  // a smaller one is noise
constexpr double kBranchInlier_m = 0.15;
constexpr double kInlierClearance_m = 0.20;
constexpr double kContradiction_m = 0.30;  // of clearance, beyond what the distance explains

struct MovedSample {
  Eigen::Vector2d arm_m;  // from the robot, in the axes of the reference
  Eigen::Vector2d position_m;
  Eigen::Vector2d direction;
};

MovedSample moved_sample(const BranchSample& sample, const Pose2& T, const geometry::SinCos& r) {
  const auto turn = [&](const Eigen::Vector2d& v) {
    return Eigen::Vector2d(r.cos * v.x() - r.sin * v.y(), r.sin * v.x() + r.cos * v.y());
  };
  const Eigen::Vector2d arm = turn(sample.position_m);
  return {arm, Eigen::Vector2d(T.x_m + arm.x(), T.y_m + arm.y()), turn(sample.direction)};
}

// A sample of the query and the one of the reference that it lies beside.
struct SamplePair {
  const BranchSample* other = nullptr;
  double across_m = 0.0;  // to the left of the other's direction
  double along_m = 0.0;
  double same_way = 1.0;  // -1: the directions are opposite
};

SamplePair partner(const Reference& reference, const BranchSample& sample,
                   const MovedSample& here) {
  const std::int32_t found = reference.branch_grid.find(here.position_m.x(), here.position_m.y());
  if (found == NearestPointGrid::kNone) return {};
  const BranchSample& other = reference.features.branches[static_cast<std::size_t>(found)];
  const Eigen::Vector2d off = here.position_m - other.position_m;
  const double along = off.x() * other.direction.x() + off.y() * other.direction.y();
  const double across = other.direction.x() * off.y() - other.direction.y() * off.x();
  const double same =
      here.direction.x() * other.direction.x() + here.direction.y() * other.direction.y();
  constexpr double kBeyond_m = 0.75 * MatchFeatures::kBranchSpacing_m;  // the end of the branch
  if (std::fabs(along) > kBeyond_m || std::fabs(same) < kSameDirection ||
      std::fabs(sample.clearance_m - other.clearance_m) > kSameClearance_m) {
    return {};
  }
  return {&other, across, along, same < 0.0 ? -1.0 : 1.0};
}

bool same_sort(NodeKind a, NodeKind b) {
  const auto narrow = [](NodeKind k) { return k == NodeKind::kDoor || k == NodeKind::kNarrowing; };
  return a == b || (narrow(a) && narrow(b));
}

void add_nodes(const Reference& reference, const MatchFeatures& query, const Pose2& T,
               const geometry::SinCos& r, double gate_m, NormalEquations& equations) {
  for (const LocalNode& node : query.nodes) {
    const double ax = r.cos * node.position_m.x() - r.sin * node.position_m.y();
    const double ay = r.sin * node.position_m.x() + r.cos * node.position_m.y();
    const LocalNode* best = nullptr;
    double best2 = gate_m * gate_m;
    for (const LocalNode& other : reference.features.nodes) {
      const double dx = T.x_m + ax - other.position_m.x();
      const double dy = T.y_m + ay - other.position_m.y();
      if (dx * dx + dy * dy >= best2 || !same_sort(node.kind, other.kind) ||
          std::fabs(node.clearance_m - other.clearance_m) > kSameClearance_m) {
        continue;
      }
      best2 = dx * dx + dy * dy;
      best = &other;
    }
    if (best == nullptr) continue;
    const double weight = repeatability(node) * repeatability(*best) /
                          (kNodeSigma_m * kNodeSigma_m) /
                          (1.0 + best2 / (kNodeCauchy_m * kNodeCauchy_m));
    const double jacobian_x[3] = {1.0, 0.0, -ay};
    const double jacobian_y[3] = {0.0, 1.0, ax};
    equations.add(jacobian_x, T.x_m + ax - best->position_m.x(), weight);
    equations.add(jacobian_y, T.y_m + ay - best->position_m.y(), weight);
  }
}

NormalEquations linearize_branches(const Reference& reference, const MatchFeatures& query,
                                   const Pose2& T, double gate_m) {
  NormalEquations equations;
  const geometry::SinCos r = geometry::sincos(T.theta_rad);
  for (const BranchSample& sample : query.branches) {
    const MovedSample here = moved_sample(sample, T, r);
    const auto [other, across, along, same_way] = partner(reference, sample, here);
    if (other == nullptr || std::fabs(across) > gate_m) continue;
    const double weight = sample.weight * other->weight;
    const Eigen::Vector2d d = other->direction;
    const double u = across / kBranchCauchy_m;
    const double jacobian[3] = {-d.y(), d.x(), d.x() * here.arm_m.x() + d.y() * here.arm_m.y()};
    equations.add(jacobian, across, weight / (kAcrossSigma_m * kAcrossSigma_m) / (1.0 + u * u));
    // Where the clearance changes along the branch, it shows how far along it the sample is. Both
    // must rise the same way: beside a door another one may stand.
    if (std::fabs(other->slope) < kLeastSlope || sample.slope * same_way * other->slope <= 0.0) {
      continue;
    }
    const double residual = other->clearance_m + other->slope * along - sample.clearance_m;
    const double v = residual / kClearanceSigma_m;
    const double along_jacobian[3] = {
        other->slope * d.x(), other->slope * d.y(),
        other->slope * (d.y() * here.arm_m.x() - d.x() * here.arm_m.y())};
    equations.add(along_jacobian, residual,
                  weight / (kClearanceSigma_m * kClearanceSigma_m) / (1.0 + v * v));
  }
  add_nodes(reference, query, T, r, gate_m, equations);
  return equations;
}

struct BranchCounts {
  double all = 0.0;
  double in_view = 0.0;
  double inliers = 0.0;
  double violations = 0.0;
  double squared = 0.0;
};

// How the branches of the reference see one sample of the query.
void count_sample(const Reference& reference, const BranchSample& sample, const MovedSample& here,
                  BranchCounts& counts) {
  counts.all += sample.weight;
  const SamplePair pair = partner(reference, sample, here);
  if (pair.other != nullptr && std::fabs(pair.across_m) <= kBranchInlier_m &&
      std::fabs(pair.other->clearance_m + pair.other->slope * pair.along_m - sample.clearance_m) <=
          kInlierClearance_m) {
    counts.in_view += sample.weight;
    counts.inliers += sample.weight;
    counts.squared += sample.weight * pair.across_m * pair.across_m;
    return;
  }
  bool in_view = false;
  bool contradicted = false;
  for (const BranchSample& other : reference.features.branches) {
    const double distance_m = std::sqrt((here.position_m - other.position_m).squaredNorm());
    in_view = in_view || distance_m < std::max(kReach_m, other.clearance_m);
    contradicted = contradicted || std::fabs(other.clearance_m - sample.clearance_m) >
                                       distance_m + kContradiction_m;
  }
  if (in_view) counts.in_view += sample.weight;
  if (in_view && contradicted) counts.violations += sample.weight;
}

}  // namespace

Eigen::Matrix3d branch_information_at(const Reference& reference, const MatchFeatures& query,
                                      const Pose2& T_reference_query) {
  const NormalEquations equations =
      linearize_branches(reference, query, T_reference_query, kBranchGate.last_m);
  if (equations.points < kFewestElements) return Eigen::Matrix3d::Zero();
  return equations.hessian;
}

PoseEvidence branch_evidence_at(const Reference& reference, const MatchFeatures& query,
                                const Pose2& T_reference_query) {
  PoseEvidence evidence;
  evidence.information = branch_information_at(reference, query, T_reference_query);
  const geometry::SinCos r = geometry::sincos(T_reference_query.theta_rad);
  BranchCounts counts;
  for (const BranchSample& sample : query.branches) {
    count_sample(reference, sample, moved_sample(sample, T_reference_query, r), counts);
  }
  if (counts.in_view <= 0.0) return evidence;
  evidence.overlap = counts.in_view / counts.all;
  evidence.inliers = counts.inliers / counts.in_view;
  evidence.violations = counts.violations / counts.in_view;
  if (counts.inliers > 0.0) evidence.residual_rms_m = std::sqrt(counts.squared / counts.inliers);
  return evidence;
}

Alignment align_branches(const Reference& reference, const MatchFeatures& query,
                         const Pose2& T_first_guess, const PosePrior& prior) {
  return align_with(T_first_guess, prior, kBranchGate, kFewestElements,
                    [&](const Pose2& T, double gate_m) {
                      return linearize_branches(reference, query, T, gate_m);
                    });
}

}  // namespace topogeo::localization
