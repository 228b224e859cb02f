#include "topogeo/exchange/g2o.hpp"

#include <map>
#include <sstream>

#include <Eigen/LU>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/slam/pose_graph.hpp"

#include "readers.hpp"
#include "sample_floor.hpp"
#include "sample_stops.hpp"

namespace topogeo::exchange {
namespace {

using localization::PoseGraph;

struct ReadGraph {
  PoseGraph graph;
  std::map<std::uint32_t, std::uint32_t> index;  // index in the graph by id in the file
};

/// The text as our own solver reads it.
ReadGraph graph_of(const std::string& text, double stretch = 0.0) {
  ReadGraph out;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream in(line);
    std::string tag;
    in >> tag;
    if (tag == "VERTEX_SE2") {
      std::uint32_t id = 0;
      geometry::Pose2 pose;
      in >> id >> pose.x_m >> pose.y_m >> pose.theta_rad;
      if (!out.index.empty()) pose.x_m += stretch;
      out.index[id] = out.graph.add_pose(pose);
    } else if (tag == "EDGE_SE2") {
      std::uint32_t a = 0;
      std::uint32_t b = 0;
      localization::PoseGraphEdge edge;
      Eigen::Matrix3d information;
      in >> a >> b >> edge.T_from_to.x_m >> edge.T_from_to.y_m >> edge.T_from_to.theta_rad;
      for (int row = 0; row < 3; ++row) {
        for (int column = row; column < 3; ++column) {
          in >> information(row, column);
          information(column, row) = information(row, column);
        }
      }
      edge.from = out.index.at(a);
      edge.to = out.index.at(b);
      edge.kind = localization::EdgeKind::kSequential;
      edge.covariance = information.inverse();
      out.graph.add_edge(edge);
    }
  }
  return out;
}

storage::MapDocument connected() {
  storage::MapDocument document = sample_stops();
  // Joins the last stop, which follows an unlocated one.
  document.loop_closures.push_back({1, 5, {0.0, 0.0, 0.0}});
  return document;
}

class G2o : public ScratchTest {};

TEST_F(G2o, KeepsTheRulesOfItsLoader) {
  // Five located stops; three steps and two loops; the second drive's step has no located start.
  EXPECT_EQ(run_reader({"g2o", write("graph.g2o", g2o_text(connected()))}), "5 5 1\n");
}

TEST_F(G2o, OptimizingAgainMovesNothing) {
  ReadGraph read = graph_of(g2o_text(connected()));
  const std::vector<geometry::Pose2> before = read.graph.poses();
  EXPECT_TRUE(read.graph.optimize().usable);
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_NEAR(read.graph.poses()[i].x_m, before[i].x_m, 1e-6);
    EXPECT_NEAR(read.graph.poses()[i].y_m, before[i].y_m, 1e-6);
    EXPECT_NEAR(read.graph.poses()[i].theta_rad, before[i].theta_rad, 1e-6);
  }
}

TEST_F(G2o, EdgesPullPosesBack) {
  // Displaced poses return, because the edges determine them.
  ReadGraph read = graph_of(g2o_text(connected()), 0.3);
  EXPECT_TRUE(read.graph.optimize().usable);
  EXPECT_NEAR(read.graph.poses()[read.index.at(3)].x_m, 3.0, 1e-3);
  EXPECT_NEAR(read.graph.poses()[read.index.at(5)].x_m, 1.0, 1e-3);
}

TEST_F(G2o, MeasurementsThatTheMapKeepsAreWritten) {
  storage::MapDocument document = connected();
  const Eigen::Matrix3d covariance = Eigen::Vector3d(0.25, 0.5, 0.125).asDiagonal();
  document.edges = {{1, 3, {2.0, 0.0, 0.0}, covariance}};
  EXPECT_THAT(g2o_text(document), testing::HasSubstr("EDGE_SE2 1 3 2 0 0 4 0 0 2 0 8\n"));
  EXPECT_EQ(run_reader({"g2o", write("graph.g2o", g2o_text(document))}), "5 1 1\n");
}

TEST_F(G2o, AMapWithoutStopsIsAnEmptyGraph) {
  EXPECT_THAT(g2o_text({}), testing::Not(testing::HasSubstr("VERTEX")));
}

}  // namespace
}  // namespace topogeo::exchange
