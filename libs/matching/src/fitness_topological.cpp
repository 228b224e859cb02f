#include "fitness_topological.hpp"

#include <algorithm>
#include <array>

namespace topogeo::localization {
namespace {

// Fixed: fitness depends on them, and tasks do not carry them. Widths are about twice the
// resolution of the genetic search, so that it hits every peak.
constexpr auto kReach = static_cast<float>(kReach_m);
constexpr float kNodeWeight = 3.0F;  // a node fixes both coordinates, a branch sample only one
constexpr float kClearanceKernel_m = 0.30F;
constexpr float kNodeClearanceKernel_m = 2.0F * kClearanceKernel_m;

float node_kernel(float squared, float width) {
  const float u = 1.0F - std::min(squared, width * width) * (1.0F / (width * width));
  return u * u;
}

}  // namespace

void TopologicalFitness::bind(const Reference& reference, const MatchFeatures& query) {
  reference_ = &reference;
  query_ = &query;
  for (LaneArray* lanes : {&x_m_, &y_m_, &direction_x_, &direction_y_, &clearance_m_}) {
    lanes->clear();
  }
  for (const BranchSample& sample : query.branches) {
    x_m_.add(sample.position_m.x());
    y_m_.add(sample.position_m.y());
    direction_x_.add(sample.direction.x());
    direction_y_.add(sample.direction.y());
    clearance_m_.add(sample.clearance_m);
  }
  x_m_.pad(kPadding_m);
  y_m_.pad(kPadding_m);
  direction_x_.pad(0.0);
  direction_y_.pad(0.0);
  clearance_m_.pad(0.0);
  const double weight = static_cast<double>(kNodeWeight) * static_cast<double>(query.nodes.size()) +
                        static_cast<double>(query.branches.size());
  per_weight_ = weight > 0.0 ? 1.0 / weight : 0.0;
}

double TopologicalFitness::at(const geometry::Pose2& T_reference_query,
                              const geometry::SinCos& heading) const {
  const FloatPose T{static_cast<float>(T_reference_query.x_m),
                    static_cast<float>(T_reference_query.y_m), static_cast<float>(heading.sin),
                    static_cast<float>(heading.cos)};
  double sum = node_scores(T);
  for (std::size_t first = 0; first < x_m_.size(); first += kBlock) {
    sum += branch_scores(first, std::min(kBlock, x_m_.size() - first), T);
  }
  return std::min(1.0, sum * per_weight_);
}

// First all look-ups of a block, then the arithmetic on the results: interleaved, each waits for
// the other.
double TopologicalFitness::branch_scores(std::size_t first, std::size_t count,
                                         const FloatPose& T) const {
  using Lookup = std::array<float, kBlock>;
  alignas(16) Lookup dx_m, dy_m, direction_x, direction_y, clearance_m;
  for (std::size_t i = 0; i < count; i += 4) {
    const Lanes x = T.x_m + T.cos * x_m_.lanes(first + i) - T.sin * y_m_.lanes(first + i);
    const Lanes y = T.y_m + T.sin * x_m_.lanes(first + i) + T.cos * y_m_.lanes(first + i);
    const std::array<std::size_t, 4> nearest = reference_->branch_grid.find_four(x, y);
    for (std::size_t k = 0; k < 4; ++k) {
      const Reference::Branch& other = reference_->branches[nearest[k]];
      const std::size_t at = i + k;
      dx_m[at] = x[static_cast<Eigen::Index>(k)] - other.x_m;
      dy_m[at] = y[static_cast<Eigen::Index>(k)] - other.y_m;
      direction_x[at] = other.direction_x;
      direction_y[at] = other.direction_y;
      clearance_m[at] = other.clearance_m;
    }
  }
  constexpr auto kHalf2 =
      static_cast<float>(0.25 * MatchFeatures::kBranchSpacing_m * MatchFeatures::kBranchSpacing_m);
  Lanes sums = Lanes::Zero();
  for (std::size_t i = 0; i < count; i += 4) {
    const auto found = [i](const Lookup& lookup) {
      return Eigen::Map<const Lanes, Eigen::Aligned16>(&lookup[i]);
    };
    const Lanes dx = found(dx_m);
    const Lanes dy = found(dy_m);
    const Lanes other_x = found(direction_x);
    const Lanes other_y = found(direction_y);
    // Distance to the branch, not to its sample: the part across it, and the part along it beyond
    // the middle between two samples.
    const Lanes across = dx * other_y - dy * other_x;
    const Lanes beyond2 = (dx * dx + dy * dy - across * across - kHalf2).max(0.0F);
    const Lanes own_x = direction_x_.lanes(first + i);
    const Lanes own_y = direction_y_.lanes(first + i);
    const Lanes alignment =
        (T.cos * own_x - T.sin * own_y) * other_x + (T.sin * own_x + T.cos * own_y) * other_y;
    const Lanes clearance = found(clearance_m) - clearance_m_.lanes(first + i);
    sums += kernel(across * across + beyond2, kReach) *
            kernel(clearance * clearance, kClearanceKernel_m) * (alignment * alignment);
  }
  return sum_of(sums);
}

double TopologicalFitness::node_scores(const FloatPose& T) const {
  float sum = 0.0F;
  for (const topomap::LocalNode& node : query_->nodes) {
    const auto px = static_cast<float>(node.position_m.x());
    const auto py = static_cast<float>(node.position_m.y());
    const float x = T.x_m + T.cos * px - T.sin * py;
    const float y = T.y_m + T.sin * px + T.cos * py;
    float best = 0.0F;
    for (const topomap::LocalNode& other : reference_->features->nodes) {
      const float dx = static_cast<float>(other.position_m.x()) - x;
      const float dy = static_cast<float>(other.position_m.y()) - y;
      const float squared = dx * dx + dy * dy;
      if (squared >= kReach * kReach) continue;
      const auto difference = static_cast<float>(other.clearance_m - node.clearance_m);
      best = std::max(best, node_kernel(squared, kReach) *
                                node_kernel(difference * difference, kNodeClearanceKernel_m));
    }
    sum += best;
  }
  return static_cast<double>(kNodeWeight * sum);
}

}  // namespace topogeo::localization
