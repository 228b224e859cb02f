#include "ridge.hpp"

#include <algorithm>
#include <utility>

#include "ridge_cells.hpp"

namespace topogeo::topomap {
namespace {

class Tracer {
 public:
  Tracer(const RidgeCells& ridge, double cell_m)
      : ridge_(ridge),
        cell_m_(cell_m),
        node_of_(ridge.cells().size(), kUnassigned),
        used_(ridge.cells().size(), 0) {}

  RidgeGraph trace() {
    const auto count = static_cast<std::int32_t>(ridge_.cells().size());
    for (std::int32_t i = 0; i < count; ++i) {
      if (kept(i) && node_of_[index(i)] == kUnassigned && is_node(i)) make_node(i);
    }
    for (std::int32_t i = 0; i < count; ++i) {
      if (!kept(i) || node_of_[index(i)] == kUnassigned) continue;
      for (const std::int32_t next : ridge_.kept_neighbours(i)) {
        if (node_of_[index(next)] == kUnassigned && used_[index(next)] == 0) follow(i, next);
      }
    }
    // The rest are closed curves without a junction.
    for (std::int32_t i = 0; i < count; ++i) {
      if (!kept(i) || node_of_[index(i)] != kUnassigned || used_[index(i)] != 0) continue;
      make_node(i);
      follow(i, ridge_.kept_neighbours(i).front());
    }
    return std::move(graph_);
  }

 private:
  static constexpr std::int32_t kUnassigned = -1;

  static std::size_t index(std::int32_t i) { return static_cast<std::size_t>(i); }
  [[nodiscard]] bool kept(std::int32_t i) const { return ridge_.cells()[index(i)].kept; }
  [[nodiscard]] bool is_node(std::int32_t i) const { return ridge_.kept_neighbours(i).size() != 2; }

  // The crest is the centre of gravity of the support around a cell: finer than the grid.
  [[nodiscard]] RidgePoint point_at(std::int32_t i) const {
    const RidgeCells::Cell& cell = ridge_.cells()[index(i)];
    Eigen::Vector2d sum(0.0, 0.0);
    double weight = 0.0;
    const auto add = [&](const RidgeCells::Cell& c) {
      const double w = std::max(1e-6, static_cast<double>(c.votes.support));
      sum += w * cell_m_ * Eigen::Vector2d(c.at.x + 0.5, c.at.y + 0.5);
      weight += w;
    };
    add(cell);
    for (const std::int32_t next : ridge_.neighbours(i)) {
      if (next != RidgeCells::kNone) add(ridge_.cells()[index(next)]);
    }
    return {sum / weight,       static_cast<double>(cell.votes.clearance_m),
            cell.votes.share(), cell.first_seen,
            cell.votes.views,   cell.votes.last_seen_ns};
  }

  // Makes one node of all touching junction cells, at the best supported one.
  void make_node(std::int32_t seed) {
    const auto id = static_cast<std::int32_t>(graph_.nodes.size());
    node_of_[index(seed)] = id;
    std::vector<std::int32_t> set{seed};
    std::int32_t best = seed;
    for (std::size_t k = 0; k < set.size(); ++k) {
      const std::int32_t cell = set[k];
      if (support(cell) > support(best)) best = cell;
      if (ridge_.kept_neighbours(cell).size() < 3) continue;
      for (const std::int32_t next : ridge_.kept_neighbours(cell)) {
        if (node_of_[index(next)] != kUnassigned || ridge_.kept_neighbours(next).size() < 3) {
          continue;
        }
        node_of_[index(next)] = id;
        set.push_back(next);
      }
    }
    graph_.nodes.push_back(point_at(best));
  }

  [[nodiscard]] float support(std::int32_t i) const {
    return ridge_.cells()[index(i)].votes.support;
  }

  // Follows the curve from the node cell `from` through `next` to the node at its end.
  void follow(std::int32_t from, std::int32_t next) {
    RidgeEdge edge;
    edge.a = static_cast<std::uint32_t>(node_of_[index(from)]);
    std::int32_t previous = from;
    std::int32_t current = next;
    while (node_of_[index(current)] == kUnassigned) {
      used_[index(current)] = 1;
      edge.points.push_back(point_at(current));
      const std::vector<std::int32_t> around = ridge_.kept_neighbours(current);
      const std::int32_t onward = around[0] == previous ? around[1] : around[0];
      previous = current;
      current = onward;
    }
    edge.b = static_cast<std::uint32_t>(node_of_[index(current)]);
    graph_.edges.push_back(std::move(edge));
  }

  const RidgeCells& ridge_;
  double cell_m_;
  RidgeGraph graph_;
  std::vector<std::int32_t> node_of_;
  std::vector<char> used_;
};

}  // namespace

RidgeGraph trace_ridge(const VoteGrid& grid, const GlobalMapConfig& config) {
  const RidgeCells ridge(grid, config);
  return Tracer(ridge, config.cell_m).trace();
}

}  // namespace topogeo::topomap
