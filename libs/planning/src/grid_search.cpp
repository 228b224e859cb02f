#include "topogeo/planning/grid_search.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <stdexcept>

#include <boost/graph/astar_search.hpp>
#include <boost/property_map/function_property_map.hpp>

#include "cell_graph.hpp"

namespace topogeo::planning {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Ends a search: Boost.Graph offers no other way.
struct EnoughReached {
  std::uint32_t last;
};

// The estimate of A*, a lower bound of the path's cost.
class OctileDistance {
 public:
  OctileDistance(const SearchWindow& window, const Cell& to) : window_(&window), to_(to) {}

  double operator()(std::uint32_t vertex) const {
    return least_cost_cells(window_->cell_at(vertex), to_);
  }

 private:
  const SearchWindow* window_;
  Cell to_;
};

struct NoEstimate {
  double operator()(std::uint32_t /*vertex*/) const { return 0.0; }
};

class StopVisitor : public boost::default_astar_visitor {
 public:
  StopVisitor(std::vector<std::uint8_t>& wanted, std::size_t& left)
      : wanted_(&wanted), left_(&left) {}

  // The cost of a vertex is final when it is examined.
  template <typename Graph>
  void examine_vertex(std::uint32_t vertex, const Graph& /*graph*/) {
    if ((*wanted_)[vertex] == 0) return;
    (*wanted_)[vertex] = 0;
    if (--*left_ == 0) throw EnoughReached{vertex};
  }

 private:
  std::vector<std::uint8_t>* wanted_;
  std::size_t* left_;
};

class Search {
 public:
  explicit Search(const SearchWindow& window)
      : window_(window),
        cost_(window.mask().size(), kInfinity),
        rank_(window.mask().size(), kInfinity),
        before_(window.mask().size(), 0),
        color_(window.mask().size(), boost::white_color),
        wanted_(window.mask().size(), 0) {}

  /// Ends at the first `most` of the cells. Returns the vertex of the last one that was needed.
  template <typename Estimate>
  std::optional<std::uint32_t> run(const Cell& from, std::span<const Cell> to,
                                   const Estimate& estimate,
                                   std::size_t most = std::numeric_limits<std::size_t>::max()) {
    for (const Cell& cell : to) {
      if (!window_.open(cell) || wanted_[window_.index(cell)] != 0) continue;
      wanted_[window_.index(cell)] = 1;
      ++left_;
    }
    left_ = std::min(left_, most);
    if (left_ == 0 || !window_.open(from)) return std::nullopt;
    const std::uint32_t start = window_.index(from);
    cost_[start] = 0.0;
    rank_[start] = estimate(start);
    before_[start] = start;
    const CellGraph graph(window_);
    const float* const slowness = window_.slowness().empty() ? nullptr : window_.slowness().data();
    const auto weight = boost::make_function_property_map<CellEdge>([=](const CellEdge& edge) {
      const double length = edge.diagonal ? std::numbers::sqrt2 : 1.0;
      if (slowness == nullptr) return length;
      return length * 0.5 * (double{slowness[edge.from]} + double{slowness[edge.to]});
    });
    try {
      boost::astar_search_no_init(graph, start, estimate, StopVisitor(wanted_, left_),
                                  before_.data(), rank_.data(), cost_.data(), weight, color_.data(),
                                  boost::typed_identity_property_map<std::uint32_t>(),
                                  std::less<>(), std::plus<>(), kInfinity, 0.0);
    } catch (const EnoughReached& reached) {
      return reached.last;
    }
    return std::nullopt;
  }

  [[nodiscard]] std::optional<CellPath> path_to(const Cell& to) const {
    if (!window_.open(to)) return std::nullopt;
    std::uint32_t vertex = window_.index(to);
    if (cost_[vertex] == kInfinity || wanted_[vertex] != 0) return std::nullopt;
    CellPath path;
    path.cost_cells = cost_[vertex];
    path.cells.push_back(to);
    while (before_[vertex] != vertex) {
      vertex = before_[vertex];
      path.cells.push_back(window_.cell_at(vertex));
    }
    std::reverse(path.cells.begin(), path.cells.end());
    return path;
  }

 private:
  const SearchWindow& window_;
  std::vector<double> cost_;
  std::vector<double> rank_;
  std::vector<std::uint32_t> before_;
  std::vector<boost::default_color_type> color_;
  std::vector<std::uint8_t> wanted_;
  std::size_t left_ = 0;
};

}  // namespace

CellBox grown(const CellBox& box, std::int32_t cells, const GridFrame& frame) {
  return {{std::max(box.low.column - cells, 0), std::max(box.low.row - cells, 0)},
          {std::min(box.high.column + cells, frame.columns - 1),
           std::min(box.high.row + cells, frame.rows - 1)}};
}

CellBox whole(const GridFrame& frame) {
  return {{0, 0}, {frame.columns - 1, frame.rows - 1}};
}

SearchWindow::SearchWindow(const FreeSpace& space, const CellBox& box, Rules rules)
    : box_(box), stride_(static_cast<std::uint32_t>(box.high.column - box.low.column + 3)) {
  mask_.assign(static_cast<std::size_t>(box.high.row - box.low.row + 3) * stride_, 0);
  for (std::int32_t row = box.low.row; row <= box.high.row; ++row) {
    std::size_t to = index({box.low.column, row});
    std::size_t from = space.frame().index({box.low.column, row});
    for (std::int32_t column = box.low.column; column <= box.high.column; ++column) {
      mask_[to++] = space.passable(from++) ? 1 : 0;
    }
  }
  if (rules == Rules::kIgnored || !space.rules().guides()) return;
  slowness_.assign(mask_.size(), 1.0F);
  directions_.assign(mask_.size(), 0xFF);
  for (std::int32_t row = box.low.row; row <= box.high.row; ++row) {
    std::size_t to = index({box.low.column, row});
    std::size_t from = space.frame().index({box.low.column, row});
    for (std::int32_t column = box.low.column; column <= box.high.column; ++column, ++to, ++from) {
      slowness_[to] = space.rules().slowness(from);
      directions_[to] = space.rules().directions(from);
    }
  }
}

SearchWindow::SearchWindow(const GridFrame& frame, const CellBox& box,
                           std::span<const std::uint16_t> labels, std::uint16_t label)
    : box_(box), stride_(static_cast<std::uint32_t>(box.high.column - box.low.column + 3)) {
  mask_.assign(static_cast<std::size_t>(box.high.row - box.low.row + 3) * stride_, 0);
  for (std::int32_t row = box.low.row; row <= box.high.row; ++row) {
    std::size_t to = index({box.low.column, row});
    std::size_t from = frame.index({box.low.column, row});
    for (std::int32_t column = box.low.column; column <= box.high.column; ++column) {
      mask_[to++] = labels[from++] == label ? 1 : 0;
    }
  }
}

void SearchWindow::set_slowness(const GridFrame& frame, std::span<const float> slowness) {
  slowness_.assign(mask_.size(), 1.0F);
  for (std::int32_t row = box_.low.row; row <= box_.high.row; ++row) {
    std::size_t to = index({box_.low.column, row});
    std::size_t from = frame.index({box_.low.column, row});
    for (std::int32_t column = box_.low.column; column <= box_.high.column; ++column) {
      slowness_[to++] = slowness[from++];
    }
  }
}

void SearchWindow::close(const Cell& cell) {
  if (box_.contains(cell)) mask_[index(cell)] = 0;
}

void SearchWindow::close_disc(const Cell& cell, double radius_cells) {
  const auto reach = static_cast<std::int32_t>(radius_cells);
  for (std::int32_t y = -reach; y <= reach; ++y) {
    for (std::int32_t x = -reach; x <= reach; ++x) {
      if (x * x + y * y <= radius_cells * radius_cells) close({cell.column + x, cell.row + y});
    }
  }
}

double cost_cells(std::span<const Cell> cells) {
  std::size_t straight = 0;
  std::size_t diagonal = 0;
  for (std::size_t i = 1; i < cells.size(); ++i) {
    const bool is_diagonal =
        cells[i].column != cells[i - 1].column && cells[i].row != cells[i - 1].row;
    ++(is_diagonal ? diagonal : straight);
  }
  return static_cast<double>(straight) + std::numbers::sqrt2 * static_cast<double>(diagonal);
}

double least_cost_cells(const Cell& a, const Cell& b) {
  const int along = std::abs(a.column - b.column);
  const int across = std::abs(a.row - b.row);
  return std::max(along, across) + (std::numbers::sqrt2 - 1.0) * std::min(along, across);
}

std::optional<CellPath> shortest_path(const SearchWindow& window, const Cell& from,
                                      const Cell& to) {
  Search search(window);
  search.run(from, {&to, 1}, OctileDistance(window, to));
  return search.path_to(to);
}

std::vector<std::optional<CellPath>> shortest_paths(const SearchWindow& window, const Cell& from,
                                                    std::span<const Cell> to) {
  Search search(window);
  search.run(from, to, NoEstimate{});
  std::vector<std::optional<CellPath>> paths;
  paths.reserve(to.size());
  for (const Cell& cell : to) paths.push_back(search.path_to(cell));
  return paths;
}

std::optional<CellPath> path_to_nearest(const SearchWindow& window, const Cell& from,
                                        std::span<const Cell> to) {
  Search search(window);
  const auto reached = search.run(from, to, NoEstimate{}, 1);
  return reached ? search.path_to(window.cell_at(*reached)) : std::nullopt;
}

std::vector<bool> reached_cells(const SearchWindow& window, const GridFrame& frame,
                                const Cell& from) {
  std::vector<bool> reached(frame.size(), false);
  if (!window.open(from)) return reached;
  const CellGraph graph(window);
  reached[frame.index(from)] = true;
  std::vector<std::uint32_t> edge = {window.index(from)};
  while (!edge.empty()) {
    const std::uint32_t vertex = edge.back();
    edge.pop_back();
    for (std::uint32_t left = graph.neighbours(vertex); left != 0; left &= left - 1) {
      const std::uint32_t next =
          graph.neighbour(vertex, static_cast<std::size_t>(__builtin_ctz(left)));
      const std::size_t index = frame.index(window.cell_at(next));
      if (reached[index]) continue;
      reached[index] = true;
      edge.push_back(next);
    }
  }
  return reached;
}

}  // namespace topogeo::planning
