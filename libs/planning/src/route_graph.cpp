#include "topogeo/planning/route_graph.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include <boost/graph/compressed_sparse_row_graph.hpp>
#include <boost/graph/dijkstra_shortest_paths.hpp>
#include <boost/property_map/function_property_map.hpp>

namespace topogeo::planning {
namespace {

constexpr double kUnreached = std::numeric_limits<double>::infinity();
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

struct Directed {
  double cost = 0.0;
  std::uint32_t edge = 0;  // index in the given edges
};

using CompressedGraph =
    boost::compressed_sparse_row_graph<boost::directedS, boost::no_property, Directed,
                                       boost::no_property, std::uint32_t, std::uint32_t>;

void check_index(const char* what, std::uint32_t index, std::size_t count) {
  if (index < count) return;
  throw std::invalid_argument("route graph: " + std::string(what) + " " + std::to_string(index) +
                              " does not exist, there are " + std::to_string(count));
}

void check_cost(const char* what, double cost) {
  if (std::isfinite(cost) && cost >= 0.0) return;
  throw std::invalid_argument("route graph: the cost of " + std::string(what) + " is " +
                              std::to_string(cost) + ", expected a finite number of 0 or more");
}

// Ends the search: Boost.Graph offers no other way.
struct BestKnown {};

// Records the edges of the tree and the best exit; a later node that already costs as much cannot
// lead to a better one.
class ExitVisitor : public boost::default_dijkstra_visitor {
 public:
  struct Record {
    std::vector<std::uint32_t> edge_before;
    std::vector<double> exit_cost;
    std::vector<double> cost;
    double best = kUnreached;
    std::uint32_t best_exit = kNone;
  };

  explicit ExitVisitor(Record& record) : record_(&record) {}

  void examine_vertex(std::uint32_t node, const CompressedGraph& /*graph*/) {
    if (record_->cost[node] >= record_->best) throw BestKnown{};
    const double total = record_->cost[node] + record_->exit_cost[node];
    if (total >= record_->best) return;
    record_->best = total;
    record_->best_exit = node;
  }

  template <typename Edge>
  void edge_relaxed(const Edge& edge, const CompressedGraph& graph) {
    record_->edge_before[target(edge, graph)] = graph[edge].edge;
  }

 private:
  Record* record_;
};

}  // namespace

struct RouteGraph::State {
  CompressedGraph graph;
  std::vector<GraphEdge> edges;

  [[nodiscard]] std::size_t nodes() const { return num_vertices(graph); }

  [[nodiscard]] std::vector<double> edge_costs(const ClosedParts& closed) const {
    std::vector<double> costs(edges.size());
    for (std::size_t i = 0; i < edges.size(); ++i) costs[i] = edges[i].cost;
    for (const std::uint32_t edge : closed.edges) {
      check_index("closed edge", edge, edges.size());
      costs[edge] = kUnreached;
    }
    if (closed.nodes.empty()) return costs;
    std::vector<bool> shut(nodes(), false);
    for (const std::uint32_t node : closed.nodes) {
      check_index("closed node", node, nodes());
      shut[node] = true;
    }
    for (std::size_t i = 0; i < edges.size(); ++i) {
      if (shut[edges[i].node_a] || shut[edges[i].node_b]) costs[i] = kUnreached;
    }
    return costs;
  }

  [[nodiscard]] static bool is_closed(const ClosedParts& closed, std::uint32_t node) {
    return std::find(closed.nodes.begin(), closed.nodes.end(), node) != closed.nodes.end();
  }

  ExitVisitor::Record search(std::span<const GraphAccess> entries,
                             std::span<const GraphAccess> exits, const ClosedParts& closed,
                             std::vector<std::uint32_t>& before) const {
    ExitVisitor::Record record;
    record.edge_before.assign(nodes(), kNone);
    record.exit_cost.assign(nodes(), kUnreached);
    record.cost.assign(nodes(), kUnreached);
    before.resize(nodes());
    std::vector<std::uint32_t> starts;
    starts.reserve(entries.size());
    for (const GraphAccess& exit : exits) {
      check_index("exit", exit.node, nodes());
      check_cost("an exit", exit.cost);
      if (is_closed(closed, exit.node)) continue;
      record.exit_cost[exit.node] = std::min(record.exit_cost[exit.node], exit.cost);
    }
    for (const GraphAccess& entry : entries) {
      check_index("entry", entry.node, nodes());
      check_cost("an entry", entry.cost);
      if (is_closed(closed, entry.node)) continue;
      if (record.cost[entry.node] == kUnreached) starts.push_back(entry.node);
      record.cost[entry.node] = std::min(record.cost[entry.node], entry.cost);
      before[entry.node] = entry.node;
    }
    const std::vector<double> costs = edge_costs(closed);
    const auto weight = boost::make_function_property_map<CompressedGraph::edge_descriptor>(
        [&](const CompressedGraph::edge_descriptor& edge) { return costs[graph[edge].edge]; });
    const auto index = get(boost::vertex_index, graph);
    try {
      boost::dijkstra_shortest_paths_no_init(
          graph, starts.begin(), starts.end(),
          boost::make_iterator_property_map(before.begin(), index),
          boost::make_iterator_property_map(record.cost.begin(), index), weight, index,
          std::less<>(), boost::closed_plus<double>(kUnreached), 0.0, ExitVisitor(record));
    } catch (const BestKnown&) {
      return record;
    }
    return record;
  }
};

RouteGraph::RouteGraph(std::size_t nodes, std::span<const GraphEdge> edges)
    : state_(std::make_unique<State>()) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ends;
  std::vector<Directed> properties;
  ends.reserve(2 * edges.size());
  properties.reserve(2 * edges.size());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const GraphEdge& edge = edges[i];
    check_index("node", edge.node_a, nodes);
    check_index("node", edge.node_b, nodes);
    check_cost("an edge", edge.cost);
    const Directed directed{edge.cost, static_cast<std::uint32_t>(i)};
    ends.emplace_back(edge.node_a, edge.node_b);
    ends.emplace_back(edge.node_b, edge.node_a);
    properties.insert(properties.end(), 2, directed);
  }
  state_->edges.assign(edges.begin(), edges.end());
  state_->graph = CompressedGraph(boost::edges_are_unsorted_multi_pass, ends.begin(), ends.end(),
                                  properties.begin(), static_cast<std::uint32_t>(nodes));
}

RouteGraph::RouteGraph(RouteGraph&&) noexcept = default;
RouteGraph& RouteGraph::operator=(RouteGraph&&) noexcept = default;
RouteGraph::~RouteGraph() = default;

std::optional<GraphPath> RouteGraph::cheapest(std::span<const GraphAccess> entries,
                                              std::span<const GraphAccess> exits,
                                              const ClosedParts& closed) const {
  std::vector<std::uint32_t> before;
  const ExitVisitor::Record record = state_->search(entries, exits, closed, before);
  if (record.best_exit == kNone) return std::nullopt;
  GraphPath path;
  path.cost = record.best;
  path.nodes.push_back(record.best_exit);
  // An entry that is cheaper to reach through the graph has an edge before it.
  while (record.edge_before[path.nodes.back()] != kNone) {
    path.edges.push_back(record.edge_before[path.nodes.back()]);
    path.nodes.push_back(before[path.nodes.back()]);
  }
  std::reverse(path.nodes.begin(), path.nodes.end());
  std::reverse(path.edges.begin(), path.edges.end());
  return path;
}

std::vector<bool> RouteGraph::reached(std::span<const GraphAccess> entries,
                                      const ClosedParts& closed) const {
  std::vector<std::uint32_t> before;
  const ExitVisitor::Record record = state_->search(entries, {}, closed, before);
  std::vector<bool> result(state_->nodes());
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = record.cost[i] < kUnreached;
  return result;
}

}  // namespace topogeo::planning
