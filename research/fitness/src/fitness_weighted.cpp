#include "topogeo/fitness/fitness_weighted.hpp"

#include <algorithm>
#include <cmath>

namespace topogeo::localization {
namespace {

// Fixed: fitness depends on them, and tasks do not carry them.
constexpr double kWeightedReach_m = 0.40;  // above twice the resolution of the search
constexpr double kWeightedClearance_m = 0.25;
constexpr double kElementsShare = 0.3;  // besides the walls, as in the combined form
constexpr double kWeightedNode = 3.0;   // a node fixes both coordinates, a branch sample only one

double soft(double squared, double width) {
  const double u = 1.0 - std::min(squared, width * width) / (width * width);
  return u * u;
}

// Score of a sample placed at (x, y) near another one.
double score(const BranchSample& sample, const BranchSample& other, double x, double y,
             const geometry::SinCos& r) {
  constexpr double kHalf_m = 0.5 * MatchFeatures::kBranchSpacing_m;
  const double dx = x - other.position_m.x();
  const double dy = y - other.position_m.y();
  const double across = other.direction.x() * dy - other.direction.y() * dx;
  const double along = other.direction.x() * dx + other.direction.y() * dy;
  // Distance to the branch, not to its sample.
  const double beyond = std::max(0.0, std::fabs(along) - kHalf_m);
  const double direction_x = r.cos * sample.direction.x() - r.sin * sample.direction.y();
  const double direction_y = r.sin * sample.direction.x() + r.cos * sample.direction.y();
  const double alignment = direction_x * other.direction.x() + direction_y * other.direction.y();
  const double clearance = other.clearance_m + other.slope * along - sample.clearance_m;
  return soft(across * across + beyond * beyond, kWeightedReach_m) *
         soft(clearance * clearance, kWeightedClearance_m) * alignment * alignment;
}

}  // namespace

void WeightedFitness::bind(const Reference& reference, const MatchFeatures& query,
                           const MatchTask& task) {
  reference_ = &reference;
  query_ = &query;
  prior_.bind(task);
  with_walls_ = task.evidence == MatchEvidence::kBranches;
  if (with_walls_) walls_.bind(reference, query);
  double weight = 0.0;
  for (const BranchSample& sample : query.branches) weight += sample.weight;
  for (const topomap::LocalNode& node : query.nodes) weight += kWeightedNode * repeatability(node);
  per_weight_ = weight > 0.0 ? 1.0 / weight : 0.0;
}

double WeightedFitness::at(const geometry::Pose2& T_reference_query,
                           const geometry::SinCos& heading) const {
  return of_maps(T_reference_query, heading) * prior_(T_reference_query);
}

double WeightedFitness::of_maps(const geometry::Pose2& T_reference_query,
                                const geometry::SinCos& heading) const {
  if (!with_walls_) return of_elements(T_reference_query, heading);
  const double walls = walls_.at(T_reference_query, heading);
  if (per_weight_ == 0.0) return walls;
  return kElementsShare * of_elements(T_reference_query, heading) + (1.0 - kElementsShare) * walls;
}

double WeightedFitness::of_elements(const geometry::Pose2& T, const geometry::SinCos& r) const {
  return std::min(1.0, (of_branches(T, r) + of_nodes(T, r)) * per_weight_);
}

double WeightedFitness::of_branches(const geometry::Pose2& T, const geometry::SinCos& r) const {
  double sum = 0.0;
  for (const BranchSample& sample : query_->branches) {
    const double x = T.x_m + r.cos * sample.position_m.x() - r.sin * sample.position_m.y();
    const double y = T.y_m + r.sin * sample.position_m.x() + r.cos * sample.position_m.y();
    const std::int32_t found = reference_->branch_grid.find(x, y);
    if (found == NearestPointGrid::kNone) continue;
    const BranchSample& other = reference_->features->branches[static_cast<std::size_t>(found)];
    sum += sample.weight * score(sample, other, x, y, r);
  }
  return sum;
}

double WeightedFitness::of_nodes(const geometry::Pose2& T, const geometry::SinCos& r) const {
  double sum = 0.0;
  for (const topomap::LocalNode& node : query_->nodes) {
    const double x = T.x_m + r.cos * node.position_m.x() - r.sin * node.position_m.y();
    const double y = T.y_m + r.sin * node.position_m.x() + r.cos * node.position_m.y();
    double best = 0.0;
    for (const topomap::LocalNode& other : reference_->features->nodes) {
      const double dx = other.position_m.x() - x;
      const double dy = other.position_m.y() - y;
      const double squared = dx * dx + dy * dy;
      if (squared >= kWeightedReach_m * kWeightedReach_m) continue;
      const double difference = other.clearance_m - node.clearance_m;
      best = std::max(best, soft(squared, kWeightedReach_m) *
                                soft(difference * difference, 2.0 * kWeightedClearance_m));
    }
    sum += kWeightedNode * repeatability(node) * best;
  }
  return sum;
}

}  // namespace topogeo::localization
