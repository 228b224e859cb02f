#include "topogeo/matching/coarse_search.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <tuple>

#include "topogeo/geometry/portable_math.hpp"

namespace topogeo::localization {

using geometry::Pose2;

namespace {

// Fixed: these depend on each other. The kernel spans a cell and the displacement of a point some
// metres away between two headings.
constexpr double kKernel_m = 0.60;
constexpr double kHeadingStep_rad = 0.05;
constexpr double kWidestMap_m = 250.0;
// A place with a lower share of the best score is no rival.
constexpr double kOfBest = 0.85;
constexpr double kApart_m = 0.75;
constexpr double kApart_rad = 0.3;
// Limit of leaves during the search, including neighbours of one place.
constexpr std::size_t kLeaves = 400;

struct Cell {
  int column;
  int row;
};

struct Node {
  std::uint32_t bound;  // sum over the points
  int heading;
  int column;  // offset of the points, cells
  int row;
};

bool before(const Node& a, const Node& b) {
  return std::tie(b.bound, a.heading, a.row, a.column) <
         std::tie(a.bound, b.heading, b.row, b.column);
}

class Search {
 public:
  Search(const CoarseMap& map, std::span<const Eigen::Vector2d> points_m,
         const CoarseWindow& window, double least)
      : map_(map),
        window_(window),
        points_(static_cast<double>(points_m.size())),
        threshold_(static_cast<std::uint32_t>(std::ceil(least * 255.0 * points_))) {
    headings_ = static_cast<int>(std::ceil(window.half_width.z() / kHeadingStep_rad));
    headings_ = std::min(headings_, static_cast<int>(std::numbers::pi / kHeadingStep_rad));
    for (int h = -headings_; h <= headings_; ++h) {
      const geometry::SinCos r = geometry::sincos(window.centre.theta_rad + kHeadingStep_rad * h);
      std::vector<Cell> cells;
      cells.reserve(points_m.size());
      for (const Eigen::Vector2d& p : points_m) {
        cells.push_back({map.column(window.centre.x_m + r.cos * p.x() - r.sin * p.y()),
                         map.row(window.centre.y_m + r.sin * p.x() + r.cos * p.y())});
      }
      cells_.push_back(std::move(cells));
    }
  }

  std::vector<Node> run() {
    constexpr int kTop = CoarseMap::kLevels - 1;
    constexpr int kSquare = 1 << kTop;
    reach_x_ = static_cast<int>(std::ceil(window_.half_width.x() / CoarseMap::kCell_m));
    reach_y_ = static_cast<int>(std::ceil(window_.half_width.y() / CoarseMap::kCell_m));
    std::vector<Node> roots;
    for (int h = -headings_; h <= headings_; ++h) {
      for (int row = -reach_y_; row <= reach_y_; row += kSquare) {
        for (int column = -reach_x_; column <= reach_x_; column += kSquare) {
          const Node node = bounded(kTop, h, column, row);
          if (node.bound >= threshold_) roots.push_back(node);
        }
      }
    }
    std::sort(roots.begin(), roots.end(), before);
    for (const Node& root : roots) descend(kTop, root);
    std::sort(leaves_.begin(), leaves_.end(), before);
    return leaves_;
  }

 private:
  [[nodiscard]] Node bounded(int level, int heading, int column, int row) const {
    std::uint32_t sum = 0;
    const auto turned = static_cast<std::size_t>(heading) + static_cast<std::size_t>(headings_);
    for (const Cell& cell : cells_[turned]) {
      sum += map_.at(level, cell.column + column, cell.row + row);
    }
    return {sum, heading, column, row};
  }

  void descend(int level, const Node& node) {
    if (node.bound < threshold_) return;
    if (level == 0) {
      keep(node);
      return;
    }
    const int half = 1 << (level - 1);
    std::vector<Node> parts;
    for (const int row : {node.row, node.row + half}) {
      for (const int column : {node.column, node.column + half}) {
        if (row > reach_y_ || column > reach_x_) continue;
        parts.push_back(bounded(level - 1, node.heading, column, row));
      }
    }
    std::sort(parts.begin(), parts.end(), before);
    for (const Node& part : parts) descend(level - 1, part);
  }

  void keep(const Node& leaf) {
    leaves_.push_back(leaf);
    const auto of_best = static_cast<std::uint32_t>(kOfBest * leaf.bound);
    threshold_ = std::max(threshold_, of_best);
    if (leaves_.size() < 2 * kLeaves) return;
    std::sort(leaves_.begin(), leaves_.end(), before);
    leaves_.resize(kLeaves);
    threshold_ = std::max(threshold_, leaves_.back().bound);
  }

  const CoarseMap& map_;
  const CoarseWindow& window_;
  double points_;
  std::uint32_t threshold_;
  int headings_ = 0;
  int reach_x_ = 0;
  int reach_y_ = 0;
  std::vector<std::vector<Cell>> cells_;  // of the points at each heading, without offset
  std::vector<Node> leaves_;
};

}  // namespace

int CoarseMap::column(double x_m) const {
  return static_cast<int>(std::floor((x_m - origin_m_.x()) / kCell_m));
}

int CoarseMap::row(double y_m) const {
  return static_cast<int>(std::floor((y_m - origin_m_.y()) / kCell_m));
}

CoarseMap::CoarseMap(std::span<const Eigen::Vector2d> points_m) {
  if (points_m.empty()) return;
  Eigen::Vector2d low = points_m.front();
  Eigen::Vector2d high = points_m.front();
  for (const Eigen::Vector2d& p : points_m) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  if (!((high - low).maxCoeff() <= kWidestMap_m)) {
    throw std::invalid_argument("coarse map: points spread over " +
                                std::to_string((high - low).maxCoeff()) +
                                " m, expected at most 250");
  }
  origin_m_ = low.array() - (kKernel_m + kCell_m);
  Level first;
  first.columns = column(high.x() + kKernel_m) + 2;
  first.rows = row(high.y() + kKernel_m) + 2;
  const auto width = static_cast<std::size_t>(first.columns);
  first.cells.assign(width * static_cast<std::size_t>(first.rows), 0);
  constexpr int kReach = static_cast<int>(kKernel_m / kCell_m) + 1;
  for (const Eigen::Vector2d& p : points_m) {
    const int c = column(p.x());
    const int r = row(p.y());
    for (int y = std::max(0, r - kReach); y <= std::min(first.rows - 1, r + kReach); ++y) {
      for (int x = std::max(0, c - kReach); x <= std::min(first.columns - 1, c + kReach); ++x) {
        const Eigen::Vector2d centre = origin_m_ + kCell_m * Eigen::Vector2d(x + 0.5, y + 0.5);
        const double u = (centre - p).squaredNorm() / (kKernel_m * kKernel_m);
        if (u >= 1.0) continue;
        const auto value = static_cast<std::uint8_t>(std::lround(255.0 * (1.0 - u) * (1.0 - u)));
        std::uint8_t& cell =
            first.cells[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)];
        cell = std::max(cell, value);
      }
    }
  }
  levels_.push_back(std::move(first));
  for (int level = 1; level < kLevels; ++level) {
    const int half = 1 << (level - 1);
    Level next;
    next.margin = 2 * half - 1;
    next.columns = levels_.front().columns + next.margin;
    next.rows = levels_.front().rows + next.margin;
    next.cells.resize(static_cast<std::size_t>(next.columns) * static_cast<std::size_t>(next.rows));
    for (int r = 0; r < next.rows; ++r) {
      for (int c = 0; c < next.columns; ++c) {
        const int column = c - next.margin;
        const int row = r - next.margin;
        next.cells[static_cast<std::size_t>(r) * static_cast<std::size_t>(next.columns) +
                   static_cast<std::size_t>(c)] =
            std::max({at(level - 1, column, row), at(level - 1, column + half, row),
                      at(level - 1, column, row + half), at(level - 1, column + half, row + half)});
      }
    }
    levels_.push_back(std::move(next));
  }
}

std::vector<CoarseMatch> search_coarsely(const CoarseMap& map,
                                         std::span<const Eigen::Vector2d> points_m,
                                         const CoarseWindow& window, double least,
                                         std::size_t count) {
  std::vector<CoarseMatch> found;
  if (points_m.empty() || map.empty() || !window.half_width.allFinite()) return found;
  const auto points = static_cast<double>(points_m.size());
  std::vector<Node> leaves = Search(map, points_m, window, least).run();
  const double lowest = leaves.empty() ? 0.0 : kOfBest * leaves.front().bound;
  for (const Node& leaf : leaves) {
    if (found.size() == count || leaf.bound < lowest) break;
    const Pose2 T{window.centre.x_m + CoarseMap::kCell_m * leaf.column,
                  window.centre.y_m + CoarseMap::kCell_m * leaf.row,
                  geometry::wrap_angle(window.centre.theta_rad + kHeadingStep_rad * leaf.heading)};
    const bool known = std::any_of(found.begin(), found.end(), [&](const CoarseMatch& other) {
      return (other.T_map_points.position_m() - T.position_m()).squaredNorm() <
                 kApart_m * kApart_m &&
             std::fabs(geometry::wrap_angle(other.T_map_points.theta_rad - T.theta_rad)) <
                 kApart_rad;
    });
    if (!known) found.push_back({T, leaf.bound / (255.0 * points)});
  }
  return found;
}

}  // namespace topogeo::localization
