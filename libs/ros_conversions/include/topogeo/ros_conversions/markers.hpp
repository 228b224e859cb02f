// Graphs and names as viewers of ROS draw them (visualization_msgs/MarkerArray).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "topogeo/ros_conversions/messages.hpp"

namespace topogeo::ros {

/// In metres, in the frame that is drawn in. Ids name the parts in viewers.
struct GraphDrawing {
  struct Node {
    std::int32_t id = 0;
    Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  };
  struct Branch {
    std::int32_t id = 0;
    bool is_virtual = false;
    std::vector<Eigen::Vector2d> points_m;  ///< with less than two it is not drawn
  };
  std::vector<Node> nodes;
  std::vector<Branch> branches;
};

struct NameDrawing {
  std::string kind;  ///< a namespace of markers
  std::int32_t id = 0;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  std::string text;
};

/// Nodes as spheres, branches as lines, after an order to delete all others.
MarkerArray graph_markers(const GraphDrawing& graph, const Header& header);
/// Texts, after the same order.
MarkerArray name_markers(const std::vector<NameDrawing>& names, const Header& header);

}  // namespace topogeo::ros
