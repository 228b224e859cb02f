#include "topogeo/voronoi/crack_graph.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>

namespace topogeo::voronoi {
namespace {

constexpr std::uint16_t kNone = NearestSiteGrid::kNone;
constexpr std::uint32_t kLoose = DiagramBranch::kLoose;

// Directions along the corners: +column, +row, -column, -row; the bit of direction d is 1 << d.
// Cells around corner (r, c), in order: (r-1,c-1), (r-1,c), (r,c), (r,c-1).
constexpr std::array<int, 4> kCellRow{-1, -1, 0, 0};
constexpr std::array<int, 4> kCellCol{-1, 0, 0, -1};
// The two of these cells beside the crack in each direction.
constexpr std::array<std::array<int, 2>, 4> kCellsBeside{{{1, 2}, {2, 3}, {3, 0}, {0, 1}}};

/// Point equally far from all of `sites`, at least three; for more than three the one with the
/// least squared differences. Empty if they are almost on a line. Independent of the order of the
/// sites.
std::optional<Eigen::Vector2d> equidistant_point(std::span<const Eigen::Vector2d> sites) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& site : sites) mean += site;
  mean /= static_cast<double>(sites.size());
  // With q_i relative to the mean, |q_i|^2 - 2 q_i x is the same number for each i.
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& site : sites) {
    const Eigen::Vector2d q = site - mean;
    scatter += q * q.transpose();
    right += 0.5 * q.squaredNorm() * q;
  }
  const double determinant = scatter(0, 0) * scatter(1, 1) - scatter(0, 1) * scatter(1, 0);
  const double trace = scatter(0, 0) + scatter(1, 1);
  if (determinant < 1e-12 * trace * trace) return std::nullopt;
  const Eigen::Vector2d offset{
      (scatter(1, 1) * right.x() - scatter(0, 1) * right.y()) / determinant,
      (scatter(0, 0) * right.y() - scatter(1, 0) * right.x()) / determinant};
  return mean + offset;
}

}  // namespace

std::array<int, 2> CrackGraph::row_col(std::uint32_t corner) const {
  return {static_cast<int>(corner / stride_), static_cast<int>(corner % stride_)};
}

std::uint32_t CrackGraph::step(std::uint32_t corner, int direction) const {
  switch (direction) {
    case 0:
      return corner + 1;
    case 1:
      return corner + stride_;
    case 2:
      return corner - 1;
    default:
      return corner - stride_;
  }
}

void CrackGraph::find_cracks() {
  for (const std::uint32_t corner : corners_) cracks_[corner] = used_[corner] = 0;
  for (const std::uint32_t corner : corners_) junction_at_[corner] = 0;
  corners_.clear();
  const int rows = grid_->rows();
  const int cols = grid_->cols();
  stride_ = static_cast<std::uint32_t>(cols) + 1;
  const std::size_t count =
      static_cast<std::size_t>(stride_) * (static_cast<std::size_t>(rows) + 1);
  if (cracks_.size() < count) {
    cracks_.resize(count, 0);
    used_.resize(count, 0);
    junction_at_.resize(count, 0);
  }
  const auto mark = [&](std::uint32_t corner, int direction) {
    const std::uint32_t other = step(corner, direction);
    if (cracks_[corner] == 0) corners_.push_back(corner);
    cracks_[corner] = static_cast<std::uint8_t>(cracks_[corner] | (1U << direction));
    if (cracks_[other] == 0) corners_.push_back(other);
    cracks_[other] = static_cast<std::uint8_t>(cracks_[other] | (1U << ((direction + 2) & 3)));
  };
  const auto differ = [](std::uint16_t a, std::uint16_t b) {
    return a != b && a != kNone && b != kNone;
  };
  for (int row = 0; row < rows; ++row) {
    const std::uint16_t* here = grid_->group_row(row);
    const std::uint16_t* above = row > 0 ? grid_->group_row(row - 1) : here;
    const std::uint32_t first = static_cast<std::uint32_t>(row) * stride_;
    for (int col = 0; col < cols; ++col) {
      // Eight bytes at a time: most cells equal their neighbours.
      if (col > 0 && col + 4 <= cols && std::memcmp(here + col, above + col, 8) == 0 &&
          std::memcmp(here + col, here + col - 1, 8) == 0) {
        col += 3;
        continue;
      }
      const std::uint32_t corner = first + static_cast<std::uint32_t>(col);
      if (differ(here[col], above[col])) mark(corner, 0);
      if (col > 0 && differ(here[col], here[col - 1])) mark(corner, 1);
    }
  }
}

std::array<std::uint16_t, 4> CrackGraph::sites_around(std::uint32_t corner) const {
  const auto [row, col] = row_col(corner);
  std::array<std::uint16_t, 4> sites{};
  for (std::size_t i = 0; i < 4; ++i) {
    const int r = row + kCellRow[i];
    const int c = col + kCellCol[i];
    const bool inside = r >= 0 && c >= 0 && r < grid_->rows() && c < grid_->cols();
    sites[i] = inside ? grid_->site(r, c) : kNone;
  }
  return sites;
}

CrackGraph::Junction CrackGraph::make_junction(std::uint32_t corner) const {
  const auto [row, col] = row_col(corner);
  const double half_m = 0.5 * grid_->resolution_m();
  Junction junction;
  junction.corner = corner;
  const Eigen::Vector2d at = grid_->centre(row, col) - Eigen::Vector2d{half_m, half_m};
  // The site of each group that is nearest to the corner.
  std::array<Eigen::Vector2d, 4> nearest;
  for (const std::uint16_t site : sites_around(corner)) {
    if (site == kNone) continue;
    const std::uint16_t group = sites_[site].group;
    const Eigen::Vector2d& position_m = sites_[site].position_m;
    const auto end = junction.groups.begin() + junction.group_count;
    const auto known = std::find(junction.groups.begin(), end, group);
    const auto i = static_cast<std::size_t>(known - junction.groups.begin());
    if (known == end) {
      junction.groups[static_cast<std::size_t>(junction.group_count++)] = group;
      nearest[i] = position_m;
    } else if ((position_m - at).squaredNorm() < (nearest[i] - at).squaredNorm()) {
      nearest[i] = position_m;
    }
  }
  if (junction.group_count < 3) return junction;
  const std::span<const Eigen::Vector2d> sites(nearest.data(),
                                               static_cast<std::size_t>(junction.group_count));
  const auto equidistant = equidistant_point(sites);
  // The centre of three sites almost on a line is undefined; the corner is within a cell of it.
  const bool near = equidistant && (*equidistant - at).norm() <= 3.0 * half_m;
  junction.position_m = near ? *equidistant : at;
  for (const Eigen::Vector2d& site : sites) {
    junction.clearance_m += (site - junction.position_m).norm() / junction.group_count;
  }
  return junction;
}

void CrackGraph::find_junctions() {
  junctions_.clear();
  for (const std::uint32_t corner : corners_) {
    if (std::popcount(cracks_[corner]) < 2) continue;
    Junction junction = make_junction(corner);
    if (junction.group_count < 3) continue;
    junction.merged_into = static_cast<std::uint32_t>(junctions_.size());
    junctions_.push_back(junction);
    junction_at_[corner] = static_cast<std::uint32_t>(junctions_.size());
  }
}

DiagramPoint CrackGraph::crack_point(std::uint32_t corner, int direction,
                                     std::array<std::uint16_t, 2>& groups) const {
  const auto [row, col] = row_col(corner);
  const auto [first, second] = kCellsBeside[static_cast<std::size_t>(direction)];
  const auto cell = [&, r = row, c = col](int i) -> std::array<int, 2> {
    return {r + kCellRow[static_cast<std::size_t>(i)], c + kCellCol[static_cast<std::size_t>(i)]};
  };
  const auto [row_p, col_p] = cell(first);
  const auto [row_q, col_q] = cell(second);
  const Eigen::Vector2d p = grid_->centre(row_p, col_p);
  const Eigen::Vector2d q = grid_->centre(row_q, col_q);
  const Site& a = sites_[grid_->site(row_p, col_p)];
  const Site& b = sites_[grid_->site(row_q, col_q)];
  groups = {std::min(a.group, b.group), std::max(a.group, b.group)};
  // The difference of the squared distances to a and b is linear along the line from p to q, so its
  // zero is exact.
  const double at_p = (p - b.position_m).squaredNorm() - (p - a.position_m).squaredNorm();
  const double at_q = (q - a.position_m).squaredNorm() - (q - b.position_m).squaredNorm();
  const double sum = at_p + at_q;
  const double t = sum > 0.0 ? std::clamp(at_p / sum, 0.0, 1.0) : 0.5;
  const Eigen::Vector2d position_m = p + t * (q - p);
  return {position_m,
          0.5 * ((position_m - a.position_m).norm() + (position_m - b.position_m).norm()), 0.0};
}

int CrackGraph::next_direction(std::uint32_t corner, int arrived) const {
  const int back = (arrived + 2) & 3;
  const unsigned open = cracks_[corner] & ~(1U << back);
  if (open == 0) return -1;
  if (std::popcount(open) == 1) return std::countr_zero(open);
  // Two groups crosswise: cells 0 and 2 are of one group, 1 and 3 of the other.
  const auto [row, col] = row_col(corner);
  const double half_m = 0.5 * grid_->resolution_m();
  const Eigen::Vector2d at = grid_->centre(row, col) - Eigen::Vector2d{half_m, half_m};
  const auto sites = sites_around(corner);
  const auto sq = [&](std::size_t i) { return (sites_[sites[i]].position_m - at).squaredNorm(); };
  const bool even_connects = std::min(sq(0), sq(2)) <= std::min(sq(1), sq(3));
  // A crack turns around a cell of the diagonal that is not connected. Cell 1 lies between the
  // cracks in directions 3 and 0, cell 2 between 0 and 1, cell 3 between 1 and 2, cell 0 between 2
  // and 3.
  constexpr std::array<int, 4> kAroundOdd{3, 2, 1, 0};
  constexpr std::array<int, 4> kAroundEven{1, 0, 3, 2};
  return (even_connects ? kAroundOdd : kAroundEven)[static_cast<std::size_t>(back)];
}

void CrackGraph::append(const DiagramPoint& point, Piece& piece) {
  if (points_.size() > piece.points.begin) {
    const double step_m = (point.position_m - points_.back().position_m).norm();
    if (step_m < 0.5 * grid_->resolution_m()) return;
    piece.length_m += step_m;
  }
  points_.push_back(point);
}

void CrackGraph::trace_from(std::uint32_t corner, int direction) {
  if (((used_[corner] >> direction) & 1U) != 0) return;
  Piece piece;
  piece.points.begin = static_cast<std::uint32_t>(points_.size());
  piece.node_a = junction_at_[corner] > 0 ? junction_at_[corner] - 1 : kLoose;
  piece.node_b = kLoose;
  if (piece.node_a != kLoose) {
    const Junction& junction = junctions_[piece.node_a];
    points_.push_back({junction.position_m, junction.clearance_m, 0.0});
  }
  while (direction >= 0 && ((used_[corner] >> direction) & 1U) == 0) {
    append(crack_point(corner, direction, piece.base_groups), piece);
    used_[corner] = static_cast<std::uint8_t>(used_[corner] | (1U << direction));
    corner = step(corner, direction);
    used_[corner] = static_cast<std::uint8_t>(used_[corner] | (1U << ((direction + 2) & 3)));
    if (junction_at_[corner] > 0) {
      piece.node_b = junction_at_[corner] - 1;
      break;
    }
    direction = next_direction(corner, direction);
  }
  if (piece.node_b != kLoose) {
    const Junction& junction = junctions_[piece.node_b];
    const std::size_t kept = piece.points.begin + (piece.node_a != kLoose ? 1U : 0U);
    if (points_.size() > kept &&
        (points_.back().position_m - junction.position_m).norm() < 0.5 * grid_->resolution_m()) {
      points_.pop_back();
    }
    if (points_.size() > piece.points.begin) {
      piece.length_m += (points_.back().position_m - junction.position_m).norm();
    }
    points_.push_back({junction.position_m, junction.clearance_m, 0.0});
  }
  piece.points.end = static_cast<std::uint32_t>(points_.size());
  piece.dropped = piece.points.size() < 2;
  pieces_.push_back(piece);
}

void CrackGraph::trace_pieces() {
  pieces_.clear();
  points_.clear();
  const auto trace_all = [&](std::uint32_t corner) {
    for (int d = 0; d < 4; ++d) {
      if (((cracks_[corner] >> d) & 1U) != 0) trace_from(corner, d);
    }
  };
  for (const Junction& junction : junctions_) trace_all(junction.corner);
  for (const std::uint32_t corner : corners_) {
    if (std::popcount(cracks_[corner]) == 1) trace_all(corner);
  }
  // The remaining cracks are closed curves.
  for (const std::uint32_t corner : corners_) trace_all(corner);
}

std::uint32_t CrackGraph::root_of(std::uint32_t junction) const {
  while (junctions_[junction].merged_into != junction) junction = junctions_[junction].merged_into;
  return junction;
}

void CrackGraph::merge_junctions(double longest_m) {
  for (Piece& piece : pieces_) {
    if (piece.node_a == kLoose || piece.node_b == kLoose || piece.length_m > longest_m) continue;
    const std::uint32_t a = root_of(piece.node_a);
    const std::uint32_t b = root_of(piece.node_b);
    junctions_[std::max(a, b)].merged_into = std::min(a, b);
    piece.dropped = true;
  }
}

void CrackGraph::drop_short_pieces(double shortest_m) {
  for (Piece& piece : pieces_) {
    const bool loose = piece.node_a == kLoose || piece.node_b == kLoose;
    if (loose && piece.length_m < shortest_m) piece.dropped = true;
  }
}

void CrackGraph::write_nodes(LocalVoronoiDiagram& out) {
  out.nodes.clear();
  node_of_.assign(junctions_.size(), kLoose);
  members_.assign(junctions_.size(), 0);
  for (Piece& piece : pieces_) {
    if (piece.node_a != kLoose) piece.node_a = root_of(piece.node_a);
    if (piece.node_b != kLoose) piece.node_b = root_of(piece.node_b);
    if (piece.dropped) continue;
    if (piece.node_a != kLoose) node_of_[piece.node_a] = 0;
    if (piece.node_b != kLoose) node_of_[piece.node_b] = 0;
  }
  for (std::uint32_t i = 0; i < junctions_.size(); ++i) {
    const std::uint32_t root = root_of(i);
    if (node_of_[root] == kLoose) continue;
    if (root == i) {
      node_of_[i] = static_cast<std::uint32_t>(out.nodes.size());
      out.nodes.emplace_back();
    }
    DiagramNode& node = out.nodes[node_of_[root]];
    const double weight = 1.0 / ++members_[root];
    node.position_m += weight * (junctions_[i].position_m - node.position_m);
    node.clearance_m += weight * (junctions_[i].clearance_m - node.clearance_m);
  }
}

// Junctions of one node share most of their groups.
void CrackGraph::write_node_groups(LocalVoronoiDiagram& out) {
  node_groups_.clear();
  for (std::uint32_t i = 0; i < junctions_.size(); ++i) {
    const std::uint32_t node = node_of_[root_of(i)];
    if (node == kLoose) continue;
    for (int k = 0; k < junctions_[i].group_count; ++k) {
      node_groups_.push_back({node, junctions_[i].groups[static_cast<std::size_t>(k)]});
    }
  }
  std::sort(node_groups_.begin(), node_groups_.end());
  node_groups_.erase(std::unique(node_groups_.begin(), node_groups_.end()), node_groups_.end());
  out.node_groups.clear();
  for (const NodeGroup& entry : node_groups_) {
    PointRun& run = out.nodes[entry.node].base_groups;
    if (run.size() == 0) run.begin = static_cast<std::uint32_t>(out.node_groups.size());
    out.node_groups.push_back(entry.group);
    run.end = static_cast<std::uint32_t>(out.node_groups.size());
  }
}

void CrackGraph::write(LocalVoronoiDiagram& out) {
  write_nodes(out);
  write_node_groups(out);
  out.branches.clear();
  out.points.clear();
  for (const Piece& piece : pieces_) {
    if (piece.dropped) continue;
    DiagramBranch branch;
    branch.base_groups = piece.base_groups;
    branch.points.begin = static_cast<std::uint32_t>(out.points.size());
    out.points.insert(out.points.end(), points_.begin() + piece.points.begin,
                      points_.begin() + piece.points.end);
    branch.points.end = static_cast<std::uint32_t>(out.points.size());
    const auto end_at = [&](std::uint32_t junction, std::uint32_t point) {
      if (junction == kLoose) return kLoose;
      const DiagramNode& node = out.nodes[node_of_[junction]];
      out.points[point] = {node.position_m, node.clearance_m, 0.0};
      return node_of_[junction];
    };
    branch.node_a = end_at(piece.node_a, branch.points.begin);
    branch.node_b = end_at(piece.node_b, branch.points.end - 1);
    out.branches.push_back(branch);
  }
}

void CrackGraph::trace(const NearestSiteGrid& grid, std::span<const Site> sites,
                       const VoronoiConfig& config, LocalVoronoiDiagram& out) {
  grid_ = &grid;
  sites_ = sites;
  find_cracks();
  find_junctions();
  trace_pieces();
  merge_junctions(config.node_merge_m);
  drop_short_pieces(config.min_branch_m);
  write(out);
}

}  // namespace topogeo::voronoi
