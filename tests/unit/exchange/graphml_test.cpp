#include "topogeo/exchange/graphml.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "readers.hpp"
#include "sample_floor.hpp"

namespace topogeo::exchange {
namespace {

using testing::HasSubstr;

class Graphml : public ScratchTest {};

TEST_F(Graphml, ReadsBackToTheLastDigit) {
  const MapGraph graph = parse_graphml(graphml_text(sample_graph(), sample_drawing().places), "f");
  expect_same(graph.map, sample_graph());
  expect_same_places(graph.drawing, sample_drawing());
}

TEST_F(Graphml, IsReadByNetworkX) {
  // Four nodes and five branches in one component, two of them parallel; two separate places.
  EXPECT_EQ(run_reader({"graphml", write("map.graphml",
                                         graphml_text(sample_graph(), sample_drawing().places))}),
            "4 5 2 3\nroom <A> & \"B\"\nKüche\n");
}

TEST_F(Graphml, ForeignFilesNeedOnlyPositions) {
  const MapGraph graph = parse_graphml(
      R"(<?xml version="1.0"?><graphml xmlns="http://graphml.graphdrawing.org/xmlns">
<key id="d0" for="node" attr.name="x" attr.type="double"><default>1.5</default></key>
<key id="d1" for="node" attr.name="y" attr.type="float"/>
<graph edgedefault="directed"><node id="start"><data key="d1">2</data></node>
<node id="end"><data key="d0">4</data><data key="d1">-2</data></node>
<edge source="start" target="end"/><edge source="end" target="start"/></graph></graphml>)",
      "f");
  ASSERT_EQ(graph.map.nodes.size(), 2U);
  EXPECT_EQ(graph.map.nodes[0].position_m, Eigen::Vector2d(1.5, 2.0));
  ASSERT_EQ(graph.map.branches.size(), 1U);
  EXPECT_EQ(graph.map.branches[0].points.back().position_m, Eigen::Vector2d(4.0, -2.0));
}

TEST_F(Graphml, NumbersMayHaveBlanksAndAPlus) {
  const MapGraph graph = parse_graphml(
      "<graphml><key id='x' for='node' attr.name='x'/><key id='y' for='node' attr.name='y'/>"
      "<key id='o' for='node' attr.name='observations'/><graph><node id='a'>"
      "<data key='x'>\n  0.5\n </data><data key='y'>+2</data><data key='o'> 3 </data></node>"
      "</graph></graphml>",
      "f");
  ASSERT_EQ(graph.map.nodes.size(), 1U);
  EXPECT_EQ(graph.map.nodes[0].position_m, Eigen::Vector2d(0.5, 2.0));
  EXPECT_EQ(graph.map.nodes[0].observations, 3U);
}

TEST_F(Graphml, NamesWhatIsWrong) {
  const auto error = [](const std::string& graph) {
    return error_of([&] {
      parse_graphml(
          "<graphml><key id='x' for='node' attr.name='x'/><key id='y' for='node' "
          "attr.name='y'/><key id='p' for='edge' attr.name='points'/><graph>" +
              graph + "</graph></graphml>",
          "f");
    });
  };
  EXPECT_THAT(error_of([] { parse_graphml("<graphml><no>", "f"); }),
              HasSubstr("f: expected XML, invalid at byte"));
  EXPECT_EQ(error_of([] { parse_graphml("<html/>", "f"); }),
            "f: expected an element graphml at the top");
  EXPECT_EQ(error("<node id='a'/>"), "f: node 'a': expected a number 'x', got nothing");
  EXPECT_EQ(error("<node id='a'><data key='x'>east</data></node>"),
            "f: node 'a': x: expected a number from -1e6 to 1e6, got 'east'");
  EXPECT_EQ(error("<node id='a'><data key='z'>1</data></node>"),
            "f: node 'a': data of key 'z', expected a key that is declared");
  const std::string node = "<node id='a'><data key='x'>1</data><data key='y'>nan</data></node>";
  EXPECT_EQ(error(node), "f: node 'a': y: expected a number from -1e6 to 1e6, got 'nan'");
  const std::string good = "<node id='a'><data key='x'>1</data><data key='y'>2</data></node>";
  EXPECT_EQ(error(good + good), "f: node 'a': expected an id that no other node has");
  EXPECT_EQ(error(good + "<edge id='e' source='a' target='b'/>"),
            "f: edge 'e': target 'b': expected the id of a node");
  EXPECT_EQ(
      error(good + "<edge id='e' source='a' target='a'><data key='p'>1 2 3</data></edge>"),
      "f: edge 'e': points: expected x, y and clearance of two points or more, got 3 numbers");
}

}  // namespace
}  // namespace topogeo::exchange
