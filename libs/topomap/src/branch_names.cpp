#include "branch_names.hpp"

#include "topogeo/topomap/arc_length.hpp"

namespace topogeo::topomap {
namespace {

// Part of a branch near its end that already belongs to the junction.
constexpr double kEnd_m = 0.5;
constexpr double kShortest_m = 1.2;  // fixed: a shorter branch is all ends

}  // namespace

void BranchNames::add(const LocalMap& map, const geometry::Pose2& T_map_robot) {
  for (const LocalBranch& b : map.branches) {
    if (b.is_virtual || !b.in_main_graph || b.points.size() < 3) continue;
    const std::vector<double> at_m = arc_lengths_m(b.points);
    if (at_m.back() < kShortest_m || named(b, T_map_robot)) continue;
    std::size_t middle = 0;
    while (at_m[middle] < 0.5 * at_m.back()) ++middle;
    anchors_.push_back(T_map_robot * b.points[middle].position_m);
    tree_.insert(Entry{{anchors_.back().x(), anchors_.back().y()},
                       static_cast<std::uint32_t>(anchors_.size() - 1)});
  }
}

bool BranchNames::named(const LocalBranch& branch, const geometry::Pose2& T_map_robot) const {
  using Box = boost::geometry::model::box<IndexPoint>;
  const std::vector<double> at_m = arc_lengths_m(branch.points);
  for (std::size_t i = 0; i < branch.points.size(); ++i) {
    if (at_m[i] < kEnd_m || at_m[i] > at_m.back() - kEnd_m) continue;
    const Eigen::Vector2d p = T_map_robot * branch.points[i].position_m;
    const Box box({p.x() - kReach_m, p.y() - kReach_m}, {p.x() + kReach_m, p.y() + kReach_m});
    for (auto it = tree_.qbegin(boost::geometry::index::intersects(box)); it != tree_.qend();
         ++it) {
      if ((anchors_[it->second] - p).norm() <= kReach_m) return true;
    }
  }
  return false;
}

}  // namespace topogeo::topomap
