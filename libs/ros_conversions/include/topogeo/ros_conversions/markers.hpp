// Converts graphs and names to markers for viewers of ROS (visualization_msgs/MarkerArray).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "topogeo/ros_conversions/messages.hpp"

namespace topogeo::ros {

/// Coordinates in metres, in the frame of the header. Viewers show the ids of the parts.
struct GraphDrawing {
  struct Node {
    std::int32_t id = 0;
    Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  };
  struct Branch {
    std::int32_t id = 0;
    bool is_virtual = false;
    std::vector<Eigen::Vector2d> points_m;  ///< not drawn with fewer than two
  };
  std::vector<Node> nodes;
  std::vector<Branch> branches;
};

struct NameDrawing {
  std::string kind;  ///< namespace of the markers
  std::int32_t id = 0;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  std::string text;
};

/// Nodes as spheres, branches as lines, after a command that deletes all other markers.
MarkerArray graph_markers(const GraphDrawing& graph, const Header& header);
/// Texts, after the same command.
MarkerArray name_markers(const std::vector<NameDrawing>& names, const Header& header);

}  // namespace topogeo::ros
