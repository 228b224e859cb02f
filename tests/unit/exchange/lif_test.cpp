#include "topogeo/exchange/lif.hpp"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "nurbs.hpp"
#include "readers.hpp"
#include "sample_floor.hpp"

namespace topogeo::exchange {
namespace {

using testing::Contains;
using testing::HasSubstr;

const ExportHeader& sample_header() {
  // 2026-11-22 10:00:00.5 UTC.
  static const ExportHeader kHeader{"floor 1", "L1", "topogeo", "b21", 1'795'341'600'500'000'000};
  return kHeader;
}

class Lif : public ScratchTest {
 protected:
  static LifText sample_lif() {
    return lif_text(sample_graph(), sample_drawing(), {}, sample_header());
  }
};

/// The part of a map that LIF keeps: no clearance, no count of observations, no version.
topomap::GlobalMap reduced(const std::vector<std::uint32_t>& branches) {
  topomap::GlobalMap map = sample_graph();
  map.version = 0;
  for (topomap::MapNode& node : map.nodes) {
    node.clearance_m = 0.0;
    node.observations = 1;
    node.last_seen_ns = 0;
  }
  std::erase_if(map.branches, [&](const topomap::MapBranch& branch) {
    return std::ranges::find(branches, branch.id) == branches.end();
  });
  for (topomap::MapBranch& branch : map.branches) {
    branch.observations = 1;
    branch.last_seen_ns = 0;
    for (topomap::BranchPoint& p : branch.points) p.clearance_m = 0.0;
  }
  return map;
}

TEST_F(Lif, ReadsBackToTheLastDigit) {
  // Branch 6 is too narrow and 8 is virtual. The lane leaves only the backward direction of 4.
  const MapGraph graph = parse_lif(sample_lif().text, "f");
  expect_same(graph.map, reduced({1, 3, 4}));
  expect_same_places(graph.drawing, sample_drawing());
  EXPECT_THAT(sample_lif().notes, Contains(HasSubstr("2 branches left out")));
}

TEST_F(Lif, KeepsTheRulesOfTheFormat) {
  EXPECT_EQ(run_reader({"lif", write("map.lif", sample_lif().text)}), "4 5 2\n");
  EXPECT_THAT(sample_lif().text, HasSubstr("\"exportTimestamp\": \"2026-11-22T10:00:00.500Z\""));
}

TEST_F(Lif, TheReaderOfTheTestsRefusesBrokenFiles) {
  const auto broken = [&](const std::string& what, const std::string& by) {
    std::string text = sample_lif().text;
    const std::size_t at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    text.replace(at, what.size(), by);
    return error_of([&] { run_reader({"lif", write("bad.lif", text)}); });
  };
  EXPECT_THAT(broken("\"rotationAllowed\"", "\"rotation\""), HasSubstr("rotationAllowed"));
  EXPECT_THAT(broken("\"startNodeId\": \"n2\"", "\"startNodeId\": \"n99\""), HasSubstr("n99"));
  EXPECT_THAT(broken("\"layoutVersion\": \"12\"", "\"layoutVersion\": 12"), HasSubstr("12"));
}

TEST_F(Lif, ReadsTheDraftOfTwoAndForeignIds) {
  const MapGraph graph = parse_lif(R"({"metaInformation":{},"origins":[{"layouts":[{"nodes":[
{"nodeId":"dock","nodePosition":{"x":1,"y":2}},{"nodeId":"gate","nodePosition":{"x":3,"y":2}}],
"edges":[{"edgeId":"e1","startNodeId":"dock","endNodeId":"gate","vehicleTypeEdgeProperties":[{}]},
{"edgeId":"e2","startNodeId":"gate","endNodeId":"dock","vehicleTypeEdgeProperties":[{}]}],
"stations":[{"stationId":"s","interactionNodeIds":["gate"]}]},{}]}]})",
                                   "f");
  ASSERT_EQ(graph.map.nodes.size(), 2U);
  ASSERT_EQ(graph.map.branches.size(), 1U);
  ASSERT_EQ(graph.drawing.places.size(), 1U);
  EXPECT_EQ(graph.drawing.places[0].position_m, Eigen::Vector2d(3.0, 2.0));
  EXPECT_THAT(graph.notes, Contains("only the first of 2 layouts is read"));
}

TEST_F(Lif, ReadsTheNamesOfTwo) {
  // Example 5 of the draft of January 2026, with a bend.
  const MapGraph graph = parse_lif(R"({"metaInformation":{"lifVersion":"2.0.0"},"origins":[
{"originId":"o","layouts":[{"layoutId":"l","nodes":[
{"nodeId":"N1","nodeDescriptor":"door","nodePosition":{"x":0,"y":0}},
{"nodeId":"N2","nodePosition":{"x":11,"y":0}}],
"edges":[{"edgeId":"N1-N2","startNodeId":"N1","endNodeId":"N2","mobileRobotTypeEdgeProperties":[
{"orientationType":"TANGENTIAL","trajectory":{"degree":1,"knotVector":[0,0,0.5,1,1],
"controlPoints":[{"x":0,"y":0},{"x":5,"y":1},{"x":11,"y":0}]}}]},
{"edgeId":"lift","startNodeId":"N2","endNodeId":"N101"}]}]}]})",
                                   "f");
  ASSERT_EQ(graph.map.branches.size(), 1U);
  EXPECT_EQ(graph.map.branches[0].points.size(), 3U);
  EXPECT_EQ(graph.map.nodes[0].kind, topomap::NodeKind::kDoor);
  EXPECT_THAT(graph.notes, Contains(HasSubstr("1 edges lead one way only")));
  EXPECT_THAT(graph.notes, Contains(HasSubstr("1 edges lead to a node that this layout lacks")));
}

TEST_F(Lif, NamesWhatIsWrong) {
  const auto error = [](const std::string& text) {
    return error_of([&] { parse_lif(text, "f"); });
  };
  EXPECT_EQ(error("{}"), "f: origins: expected a value, got nothing");
  EXPECT_EQ(error(R"({"layouts":[{"nodes":[{"nodeId":"a","nodePosition":{"x":1}}]}]})"),
            "f: layouts[0].nodes[0].nodePosition.y: expected a value, got nothing");
  const std::string nodes =
      R"({"layouts":[{"nodes":[{"nodeId":"a","nodePosition":{"x":1,"y":2}}],)";
  EXPECT_EQ(error(nodes + R"("edges":[{"edgeId":"e","startNodeId":"b","endNodeId":"a"}]}]})"),
            "f: layouts[0].edges[0].startNodeId: expected the nodeId of a node of this layout, got "
            "\"b\"");
  EXPECT_THAT(error(nodes + R"("edges":[{"edgeId":"e","startNodeId":"a","endNodeId":"a",
"vehicleTypeEdgeProperties":[{"trajectory":{"degree":2,"knotVector":[0,1],
"controlPoints":[{"x":0,"y":0},{"x":1,"y":0}]}}]}]}]})"),
              HasSubstr("trajectory: expected more control points than the degree"));
}

TEST(NurbsTest, AQuarterOfACircleIsExact) {
  // The NURBS Book, example 7.1.
  const Nurbs arc{2, {0, 0, 0, 1, 1, 1}, {{1, 0}, {1, 1}, {0, 1}}, {1, 1 / std::numbers::sqrt2, 1}};
  EXPECT_EQ(arc.fault(), "");
  const auto line = arc.polyline();
  EXPECT_EQ(line.size(), 9U);
  EXPECT_EQ(line.front(), Eigen::Vector2d(1.0, 0.0));
  EXPECT_NEAR(line.back().y(), 1.0, 1e-15);
  for (const Eigen::Vector2d& p : line) EXPECT_NEAR(p.norm(), 1.0, 1e-15);
}

TEST(NurbsTest, FaultsAreNamed) {
  EXPECT_THAT((Nurbs{1, {0, 0, 1}, {{0, 0}, {1, 0}}, {1, 1}}).fault(), HasSubstr("knotVector"));
  EXPECT_THAT((Nurbs{1, {0, 1, 0, 1}, {{0, 0}, {1, 0}}, {1, 1}}).fault(), HasSubstr("decreases"));
  EXPECT_THAT((Nurbs{1, {0, 0, 0, 1}, {{0, 0}, {1, 0}}, {1, 1}}).fault(), HasSubstr("increases"));
  EXPECT_THAT((Nurbs{1, {0, 0, 1, 1}, {{0, 0}, {1, 0}}, {1, 0}}).fault(), HasSubstr("weights"));
}

}  // namespace
}  // namespace topogeo::exchange
