#include "topogeo/planning/route_graph.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/support/random.hpp"

namespace topogeo::planning {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

//  0 --1-- 1 --1-- 2 --1-- 3     and 0 --5-- 3, a second 1 --0.5-- 2, and 4 alone
const std::vector<GraphEdge> kEdges{
    {0, 1, 1.0}, {1, 2, 1.0}, {2, 3, 1.0}, {0, 3, 5.0}, {2, 1, 0.5}};

TEST(RouteGraph, TakesTheCheaperOfTwoEdges) {
  const RouteGraph graph(5, kEdges);
  const auto path =
      graph.cheapest(std::vector<GraphAccess>{{0, 0.0}}, std::vector<GraphAccess>{{3, 0.25}});
  ASSERT_TRUE(path);
  EXPECT_DOUBLE_EQ(path->cost, 2.75);
  EXPECT_THAT(path->nodes, ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(path->edges, ElementsAre(0, 4, 2));
}

TEST(RouteGraph, WeighsEveryPairOfEntryAndExit) {
  const RouteGraph graph(5, kEdges);
  const std::vector<GraphAccess> entries{{0, 0.0}, {2, 4.0}};
  const auto far = graph.cheapest(entries, std::vector<GraphAccess>{{3, 0.0}, {1, 9.0}});
  EXPECT_DOUBLE_EQ(far.value().cost, 2.5);
  const auto touching = graph.cheapest(entries, std::vector<GraphAccess>{{3, 0.0}, {0, 2.0}});
  EXPECT_DOUBLE_EQ(touching.value().cost, 2.0);
  EXPECT_THAT(touching->nodes, ElementsAre(0));
  EXPECT_THAT(touching->edges, IsEmpty());
}

TEST(RouteGraph, GoesRoundWhatIsClosed) {
  const RouteGraph graph(5, kEdges);
  const std::vector<GraphAccess> from{{0, 0.0}};
  const std::vector<GraphAccess> to{{3, 0.0}};
  EXPECT_DOUBLE_EQ(graph.cheapest(from, to, {{}, {4}}).value().cost, 3.0);
  EXPECT_DOUBLE_EQ(graph.cheapest(from, to, {{1}, {}}).value().cost, 5.0);
  EXPECT_FALSE(graph.cheapest(from, to, {{2}, {3}}));
  EXPECT_FALSE(graph.cheapest(from, to, {{3}, {}}));
  EXPECT_FALSE(graph.cheapest(from, std::vector<GraphAccess>{{4, 0.0}}));
  EXPECT_THAT(graph.reached(from, {{2}, {3}}), ElementsAre(true, true, false, false, false));
}

TEST(RouteGraph, RefusesWhatDoesNotExist) {
  EXPECT_THAT(
      [] {
        RouteGraph(2, std::vector<GraphEdge>{{0, 2, 1.0}});
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("node 2 does not exist")));
  EXPECT_THAT(
      [] {
        RouteGraph(2, std::vector<GraphEdge>{{0, 1, -1.0}});
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("the cost of an edge")));
  const RouteGraph graph(5, kEdges);
  const std::vector<GraphAccess> good{{0, 0.0}};
  const std::vector<GraphAccess> bad{{5, 0.0}};
  EXPECT_THROW((void)graph.cheapest(good, bad), std::invalid_argument);
  EXPECT_THROW((void)graph.cheapest(bad, good), std::invalid_argument);
  EXPECT_THROW((void)graph.cheapest(good, good, {{5}, {}}), std::invalid_argument);
  EXPECT_THROW((void)graph.cheapest(good, good, {{}, {5}}), std::invalid_argument);
}

TEST(RouteGraph, AgreesWithRelaxationOnRandomGraphs) {
  support::Random random(5);
  for (int round = 0; round < 100; ++round) {
    constexpr std::uint32_t kNodes = 20;
    std::vector<GraphEdge> edges(30);
    const auto node = [&] { return static_cast<std::uint32_t>(random.below(kNodes)); };
    for (GraphEdge& edge : edges) edge = {node(), node(), random.uniform(0.0, 10.0)};
    std::vector<GraphAccess> entries(3);
    std::vector<GraphAccess> exits(3);
    for (GraphAccess& entry : entries) entry = {node(), random.uniform(0.0, 10.0)};
    for (GraphAccess& exit : exits) exit = {node(), random.uniform(0.0, 10.0)};
    std::vector<double> cost(kNodes, std::numeric_limits<double>::infinity());
    for (const GraphAccess& entry : entries) {
      cost[entry.node] = std::min(cost[entry.node], entry.cost);
    }
    for (std::uint32_t k = 0; k < kNodes; ++k) {
      for (const GraphEdge& edge : edges) {
        cost[edge.node_b] = std::min(cost[edge.node_b], cost[edge.node_a] + edge.cost);
        cost[edge.node_a] = std::min(cost[edge.node_a], cost[edge.node_b] + edge.cost);
      }
    }
    double best = std::numeric_limits<double>::infinity();
    for (const GraphAccess& exit : exits) best = std::min(best, cost[exit.node] + exit.cost);
    const auto path = RouteGraph(kNodes, edges).cheapest(entries, exits);
    ASSERT_EQ(path.has_value(), std::isfinite(best));
    if (!path) continue;
    EXPECT_NEAR(path->cost, best, 1e-9);
    ASSERT_EQ(path->edges.size() + 1, path->nodes.size());
    for (std::size_t i = 0; i < path->edges.size(); ++i) {
      const GraphEdge& edge = edges[path->edges[i]];
      EXPECT_EQ(edge.node_a + edge.node_b, path->nodes[i] + path->nodes[i + 1]);
    }
  }
}

}  // namespace
}  // namespace topogeo::planning
