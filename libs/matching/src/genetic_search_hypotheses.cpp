#include "genetic_search_hypotheses.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "topogeo/geometry/portable_math.hpp"

#include "genetic_search.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;
using geometry::SinCos;

// Fixed: the search depends on them, and tasks do not carry them.
constexpr double kEquivalentClearance_m = 0.20;
constexpr double kCell_m = 0.30;          // two of the default position resolution
constexpr double kCell_rad = 0.12;        // directions of branches are uncertain by about 5 degrees
constexpr double kNodeVotes = 3.0;        // a node fixes both coordinates, a branch sample only one
constexpr std::size_t kMostPairs = 4096;  // bounds the time of a task between rich maps
constexpr std::size_t kMostCandidates = 4096;

double likeness(double clearance_a_m, double clearance_b_m) {
  const double u = (clearance_a_m - clearance_b_m) / kEquivalentClearance_m;
  return 1.0 - u * u;
}

// Stride through the elements of both maps that keeps the number of pairs below kMostPairs.
std::size_t stride(std::size_t query, std::size_t reference) {
  const std::size_t pairs = query * reference;
  std::size_t step = 1;
  while (pairs > kMostPairs * step * step) ++step;
  return step;
}

}  // namespace

// The search space and its cells.
class BranchHypotheses::Space {
 public:
  explicit Space(const MatchTask& task)
      : centre_(task.T_reference_query),
        half_width_(task.half_width),
        heading_(geometry::sincos(task.T_reference_query.theta_rad)),
        smallest_cos_(task.half_width.z() < std::numbers::pi
                          ? geometry::sincos(task.half_width.z()).cos
                          : -2.0) {}

  [[nodiscard]] const Pose2& centre() const { return centre_; }
  [[nodiscard]] const SinCos& heading() const { return heading_; }
  [[nodiscard]] bool has_heading(const SinCos& r) const {
    return r.cos * heading_.cos + r.sin * heading_.sin >= smallest_cos_;
  }
  /// Position that lays `from` on `to` with the heading `r`; the heading itself is not set.
  [[nodiscard]] Pose2 lay(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                          const SinCos& r) const {
    return {to.x() - r.cos * from.x() + r.sin * from.y(),
            to.y() - r.sin * from.x() - r.cos * from.y(), 0.0};
  }
  [[nodiscard]] bool has_position(const Pose2& T) const {
    return std::fabs(T.x_m - centre_.x_m) <= half_width_.x() &&
           std::fabs(T.y_m - centre_.y_m) <= half_width_.y();
  }
  [[nodiscard]] std::uint64_t cell(const Pose2& T) const {
    const Eigen::Vector3d d = geometry::difference(T, centre_) + half_width_;
    const auto whole = [](double value) {
      return static_cast<std::uint64_t>(std::max(0.0, value));
    };
    return whole(d.x() / kCell_m) | whole(d.y() / kCell_m) << 20U | whole(d.z() / kCell_rad) << 40U;
  }

 private:
  Pose2 centre_;
  Eigen::Vector3d half_width_;
  SinCos heading_;
  double smallest_cos_;
};

std::span<const Pose2> BranchHypotheses::find(const MatchTask& task, const MatchFeatures& reference,
                                              const MatchFeatures& query) {
  candidates_.clear();
  poses_.clear();
  const std::size_t wanted = task.genetic.branch_hypotheses;
  if (wanted == 0) return poses_;
  const Space space(task);
  add_nodes(space, reference, query);
  add_branches(space, reference, query);
  count_cells();
  for (const Cell& cell : cells_) {
    if (poses_.size() == wanted) break;
    const Pose2& T = candidates_[cell.first].T_reference_query;
    const bool known = std::any_of(poses_.begin(), poses_.end(),
                                   [&](const Pose2& p) { return same_solution(task, p, T); });
    if (!known) poses_.push_back(T);
  }
  return poses_;
}

void BranchHypotheses::add_nodes(const Space& space, const MatchFeatures& reference,
                                 const MatchFeatures& query) {
  const std::size_t step = stride(query.nodes.size(), reference.nodes.size());
  for (std::size_t i = 0; i < query.nodes.size(); i += step) {
    for (std::size_t j = 0; j < reference.nodes.size(); j += step) {
      const topomap::LocalNode& from = query.nodes[i];
      const topomap::LocalNode& to = reference.nodes[j];
      const double like = likeness(from.clearance_m, to.clearance_m);
      if (!(like > 0.0)) continue;
      Pose2 T = space.lay(from.position_m, to.position_m, space.heading());
      if (!space.has_position(T) || candidates_.size() == kMostCandidates) continue;
      T.theta_rad = geometry::wrap_angle(space.centre().theta_rad);
      candidates_.push_back({space.cell(T), static_cast<float>(kNodeVotes * like), T});
    }
  }
}

void BranchHypotheses::add_branches(const Space& space, const MatchFeatures& reference,
                                    const MatchFeatures& query) {
  const std::size_t step = stride(query.branches.size(), reference.branches.size());
  for (std::size_t i = 0; i < query.branches.size(); i += step) {
    for (std::size_t j = 0; j < reference.branches.size(); j += step) {
      const BranchSample& from = query.branches[i];
      const BranchSample& to = reference.branches[j];
      const double like = likeness(from.clearance_m, to.clearance_m);
      if (!(like > 0.0)) continue;
      SinCos r{from.direction.x() * to.direction.y() - from.direction.y() * to.direction.x(),
               from.direction.dot(to.direction)};
      for (int side = 0; side < 2; ++side, r = {-r.sin, -r.cos}) {
        if (!space.has_heading(r)) continue;
        Pose2 T = space.lay(from.position_m, to.position_m, r);
        if (!space.has_position(T) || candidates_.size() == kMostCandidates) continue;
        T.theta_rad = geometry::atan2(r.sin, r.cos);
        candidates_.push_back({space.cell(T), static_cast<float>(like), T});
      }
    }
  }
}

// Collects every cell with a candidate, heaviest first.
void BranchHypotheses::count_cells() {
  // Equal candidates keep the order of the maps' elements; a stable sort would allocate.
  const auto before = [](const Candidate& a, const Candidate& b) {
    if (a.cell != b.cell) return a.cell < b.cell;
    if (a.weight != b.weight) return a.weight > b.weight;
    if (a.T_reference_query.x_m != b.T_reference_query.x_m) {
      return a.T_reference_query.x_m < b.T_reference_query.x_m;
    }
    if (a.T_reference_query.y_m != b.T_reference_query.y_m) {
      return a.T_reference_query.y_m < b.T_reference_query.y_m;
    }
    return a.T_reference_query.theta_rad < b.T_reference_query.theta_rad;
  };
  std::sort(candidates_.begin(), candidates_.end(), before);
  cells_.clear();
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    if (cells_.empty() || cells_.back().cell != candidates_[i].cell) {
      cells_.push_back({candidates_[i].cell, 0.0, i});
    }
    cells_.back().weight += static_cast<double>(candidates_[i].weight);
  }
  std::sort(cells_.begin(), cells_.end(), [](const Cell& a, const Cell& b) {
    return a.weight > b.weight || (a.weight == b.weight && a.cell < b.cell);
  });
}

}  // namespace topogeo::localization
