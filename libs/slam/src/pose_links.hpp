// Network of stops and edges. All edges of one pair of stops are combined, and searches follow the
// paths of least variance. The cost of a search follows the stops it reaches, not the size of the
// network.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <boost/graph/adjacency_list.hpp>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/slam/pose_graph.hpp"

namespace topogeo::localization {

class PoseLinks {
 public:
  void add_stop();
  /// `covariance` of T_from_to, in the frame of `from`.
  void add(const PoseGraphEdge& edge, const Eigen::Matrix3d& covariance);
  /// Forgets all edges between two stops.
  void remove(std::uint32_t from, std::uint32_t to);

  /// Covariance of the link between two stops, which must exist.
  [[nodiscard]] const Eigen::Matrix3d& covariance(std::uint32_t from, std::uint32_t to) const {
    return links_[link_of_.at({from, to})].covariance;
  }
  /// See PoseGraph::links_to.
  [[nodiscard]] std::vector<std::pair<std::uint32_t, Eigen::Matrix3d>> links_to(
      std::uint32_t stop) const;
  /// See PoseGraph::predict_from; `poses` are those of all stops.
  [[nodiscard]] RelativePoses relative_to(std::span<const geometry::Pose2> poses,
                                          std::uint32_t origin,
                                          std::span<const std::uint32_t> wanted,
                                          double largest_cost, std::size_t most) const;
  /// See PoseGraph::visit_nearest.
  void visit_nearest(std::span<const std::uint32_t> origins,
                     const std::function<bool(std::uint32_t, double)>& visit) const;

 private:
  /// All edges between one pair of stops taken together.
  struct Link {
    std::uint32_t from = 0;
    std::uint32_t to = 0;
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  // of T_from_to, in the frame of `from`
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    double cost = 0.0;
  };
  struct LinkIndex {
    std::uint32_t value = 0;
  };
  using Network = boost::adjacency_list<boost::vecS, boost::vecS, boost::undirectedS,
                                        boost::no_property, LinkIndex>;
  class Visitor;
  /// Scratch data of a search for each stop. Between two searches no stop is marked.
  struct Marks {
    std::vector<double> cost;
    std::vector<boost::default_color_type> colour;
    std::vector<std::uint32_t> link_to;   // by which the stop was reached
    std::vector<std::uint32_t> position;  // index in the order of reaching
    std::vector<std::uint8_t> wanted;
    std::vector<std::uint32_t> touched;
  };

  std::vector<Link> links_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> link_of_;  // index into links_
  Network network_;
  mutable Marks marks_;
};

}  // namespace topogeo::localization
