#include "topogeo/exchange/geojson.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "readers.hpp"
#include "sample_floor.hpp"

namespace topogeo::exchange {
namespace {

using testing::Contains;
using testing::HasSubstr;

class Geojson : public ScratchTest {
 protected:
  static std::string sample_text() {
    const planning::FreeSpace space = sample_space();
    const storage::MapDrawing drawing = sample_drawing();
    const topomap::GlobalMap map = sample_graph();
    return geojson_text(map, drawing, route_network(map, drawing, &space, {}));
  }
};

TEST_F(Geojson, ReadsBackToTheLastDigit) {
  const MapGraph graph = parse_geojson(sample_text(), "f");
  expect_same(graph.map, sample_graph());
  expect_same_places(graph.drawing, sample_drawing());
  expect_same_zones(graph.drawing, sample_drawing());
}

TEST_F(Geojson, IsTheSameTextAgain) {
  EXPECT_EQ(sample_text(), sample_text());
}

TEST_F(Geojson, IsReadByTheRulesOfNav2) {
  const RouteNetwork network = route_network(sample_graph(), sample_drawing(), nullptr, {});
  std::size_t edges = 0;
  for (const NetworkPiece& piece : network.pieces) {
    edges += piece.rule.forward;
    edges += piece.rule.backward;
  }
  EXPECT_EQ(edges, 2 * network.pieces.size() - 2);  // the lane
  EXPECT_EQ(run_reader({"geojson", write("map.geojson", sample_text())}),
            std::to_string(network.nodes.size()) + " " + std::to_string(edges) + "\n");
  EXPECT_THAT(sample_text(), HasSubstr("\"abs_speed_limit\":0.35"));
}

TEST_F(Geojson, TheReaderOfTheTestsRefusesWhatNav2Does) {
  // A good file with one change each; without this test the reader would prove nothing.
  const auto broken = [&](const std::string& what, const std::string& by) {
    std::string text = sample_text();
    const std::size_t at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    text.replace(at, what.size(), by);
    return error_of([&] { run_reader({"geojson", write("bad.geojson", text)}); });
  };
  EXPECT_THAT(broken("\"clearance\":0.9", "\"clearance\":null"), HasSubstr("null"));
  EXPECT_THAT(broken("\"id\":200000", "\"id\":2"), HasSubstr("twice"));
  EXPECT_THAT(broken("\"startid\":2,", "\"startid\":77,"), HasSubstr("unknown end"));
}

TEST_F(Geojson, ForeignGraphsBecomeStraightBranches) {
  const MapGraph graph = parse_geojson(R"({"type":"FeatureCollection","features":[
{"type":"Feature","properties":{"id":0,"frame":"map"},"geometry":{"type":"Point","coordinates":[1.5,-2.0]}},
{"type":"Feature","properties":{"id":3,"metadata":{"name":"dock"}},"geometry":{"type":"Point","coordinates":[4,0.5]}},
{"type":"Feature","properties":{"id":10,"startid":0,"endid":3},"geometry":{"type":"MultiLineString","coordinates":[]}},
{"type":"Feature","properties":{"id":11,"startid":3,"endid":0},"geometry":{"type":"LineString"}},
{"type":"Feature","properties":{"name":"lawn"},"geometry":{"type":"Polygon","coordinates":[[[0,0],[1,0],[1,1],[0,0]]]}},
{"type":"Feature","properties":{},"geometry":{"type":"MultiPoint","coordinates":[]}}]})",
                                       "f");
  ASSERT_EQ(graph.map.nodes.size(), 2U);
  EXPECT_EQ(graph.map.nodes[1].id, 3U);
  ASSERT_EQ(graph.map.branches.size(), 1U);
  EXPECT_EQ(graph.map.branches[0].points[1].position_m, Eigen::Vector2d(4.0, 0.5));
  ASSERT_EQ(graph.drawing.places.size(), 1U);
  EXPECT_EQ(graph.drawing.places[0].name, "dock");
  ASSERT_EQ(graph.drawing.zones.size(), 1U);
  EXPECT_EQ(graph.drawing.zones[0].polygon_m.size(), 3U);
  EXPECT_THAT(graph.notes, Contains(HasSubstr("MultiPoint left out")));
}

TEST_F(Geojson, NamesWhatIsWrong) {
  const auto error = [](const std::string& text) {
    return error_of([&] { parse_geojson(text, "f.geojson"); });
  };
  EXPECT_EQ(error("{"), "f.geojson: expected JSON, invalid at byte 2");
  EXPECT_EQ(error("{}"), "f.geojson: features: expected a value, got nothing");
  EXPECT_EQ(
      error(
          R"({"features":[{"geometry":{"type":"Point","coordinates":[0,0]},"properties":{"id":-1}}]})"),
      "f.geojson: features[0].properties.id: expected a whole number from 0 to 4294967295, "
      "got -1");
  EXPECT_EQ(
      error(
          R"({"features":[{"geometry":{"type":"Point","coordinates":[0,"x"]},"properties":{"id":1}}]})"),
      "f.geojson: features[0].geometry.coordinates[1]: expected a number, got \"x\"");
  EXPECT_EQ(
      error(
          R"({"features":[{"geometry":{"type":"LineString"},"properties":{"id":1,"startid":5,"endid":6}}]})"),
      "f.geojson: branch 1 ends at node 5, which does not exist");
}

TEST_F(Geojson, NodesWithLargeIdsGetOthersInTheFileAlone) {
  topomap::GlobalMap map = sample_graph();
  // Ids of virtual nodes are this large.
  map.nodes.back().id = 2'147'483'650U;
  for (topomap::MapBranch& branch : map.branches) {
    if (branch.node_b == 12) branch.node_b = map.nodes.back().id;
  }
  const std::string text = geojson_text(map, {}, route_network(map, {}, nullptr, {}));
  EXPECT_THAT(text, HasSubstr("\"id\":100000,"));
  EXPECT_THAT(text, testing::Not(HasSubstr("\"startid\":2147483650")));
  run_reader({"geojson", write("large.geojson", text)});
  expect_same(parse_geojson(text, "f").map, map);
}

}  // namespace
}  // namespace topogeo::exchange
