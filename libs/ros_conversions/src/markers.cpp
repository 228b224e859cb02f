#include "topogeo/ros_conversions/markers.hpp"

#include <utility>

#include "topogeo/ros_conversions/geometry.hpp"

namespace topogeo::ros {
namespace {

// visualization_msgs/Marker
constexpr std::int32_t kSphere = 2;
constexpr std::int32_t kLineStrip = 4;
constexpr std::int32_t kText = 9;
constexpr std::int32_t kDeleteAll = 3;

struct Color {
  float r = 0.0F;
  float g = 0.0F;
  float b = 0.0F;
};
constexpr Color kBranchColor{0.1F, 0.4F, 0.9F};
constexpr Color kVirtualColor{0.6F, 0.6F, 0.6F};
constexpr Color kNodeColor{0.9F, 0.3F, 0.1F};
constexpr Color kNameColor{0.1F, 0.1F, 0.1F};
constexpr double kNode_m = 0.2;
constexpr double kLine_m = 0.05;
constexpr double kLetter_m = 0.4;

Marker marker(const std::string& kind, std::int32_t id, std::int32_t type, const Header& header,
              const Color& color, double size_m) {
  Marker out;
  out.header_(header);
  out.ns_(kind);
  out.id_(id);
  out.type_(type);
  out.pose_().orientation_().w_(1.0);
  out.scale_().x_(size_m);
  out.scale_().y_(size_m);
  out.scale_().z_(size_m);
  out.color_().r_(color.r);
  out.color_().g_(color.g);
  out.color_().b_(color.b);
  out.color_().a_(1.0F);
  return out;
}

MarkerArray cleared(const Header& header) {
  MarkerArray array;
  Marker& all = array.markers_().emplace_back();
  all.header_(header);
  all.action_(kDeleteAll);
  all.pose_().orientation_().w_(1.0);
  return array;
}

}  // namespace

MarkerArray graph_markers(const GraphDrawing& graph, const Header& header) {
  MarkerArray array = cleared(header);
  for (const GraphDrawing::Node& node : graph.nodes) {
    Marker out = marker("nodes", node.id, kSphere, header, kNodeColor, kNode_m);
    out.pose_().position_(point_of(node.position_m));
    array.markers_().push_back(std::move(out));
  }
  for (const GraphDrawing::Branch& branch : graph.branches) {
    if (branch.points_m.size() < 2) continue;
    Marker out = marker(branch.is_virtual ? "virtual_branches" : "branches", branch.id, kLineStrip,
                        header, branch.is_virtual ? kVirtualColor : kBranchColor, kLine_m);
    for (const Eigen::Vector2d& point_m : branch.points_m) {
      out.points_().push_back(point_of(point_m));
    }
    array.markers_().push_back(std::move(out));
  }
  return array;
}

MarkerArray name_markers(const std::vector<NameDrawing>& names, const Header& header) {
  MarkerArray array = cleared(header);
  for (const NameDrawing& name : names) {
    Marker out = marker(name.kind, name.id, kText, header, kNameColor, kLetter_m);
    out.pose_().position_(point_of(name.position_m));
    out.text_(name.text);
    array.markers_().push_back(std::move(out));
  }
  return array;
}

}  // namespace topogeo::ros
