#include "topogeo/localization/pose_graph.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <Eigen/LU>
#include <boost/graph/compressed_sparse_row_graph.hpp>
#include <boost/graph/dijkstra_shortest_paths.hpp>

namespace topogeo::localization {
namespace {

using geometry::Pose2;

// One standard deviation of heading moves what is seen at this distance.
constexpr double kLeverArm_m = 5.0;

double path_cost(const Eigen::Matrix3d& c) {
  return c(0, 0) + c(1, 1) + kLeverArm_m * kLeverArm_m * c(2, 2);
}

struct Hop {
  double cost = 0.0;
  std::uint32_t link = 0;  // index into PoseGraph::links_
};

}  // namespace

std::uint32_t PoseGraph::add_pose(const Pose2& T_map_robot) {
  poses_.push_back(T_map_robot);
  return static_cast<std::uint32_t>(poses_.size() - 1);
}

void PoseGraph::add_edge(const PoseGraphEdge& edge) {
  if (edge.from >= edge.to || edge.to >= poses_.size()) {
    throw std::invalid_argument(
        "pose graph: an edge must lead from an earlier stop to a later one");
  }
  edges_.push_back(edge);
  add_to_link(edge);
}

void PoseGraph::add_to_link(const PoseGraphEdge& edge) {
  const auto [found, fresh] = link_of_.try_emplace({edge.from, edge.to}, links_.size());
  if (fresh) {
    Link& link = links_.emplace_back();
    link.from = edge.from;
    link.to = edge.to;
  }
  Link& link = links_[found->second];
  link.information += edge.covariance.inverse();
  link.covariance = link.information.inverse();
}

double PoseGraph::disagreement(const PoseGraphEdge& edge) const {
  const Pose2 now = geometry::between(poses_[edge.from], poses_[edge.to]);
  const Eigen::Vector3d error = geometry::difference(now, edge.T_from_to);
  return error.dot(edge.covariance.inverse() * error);
}

void PoseGraph::place_last_pose() {
  const auto last = static_cast<std::uint32_t>(poses_.size() - 1);
  constexpr int kIterations = 5;
  for (int k = 0; k < kIterations; ++k) {
    Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    Pose2& T_map_last = poses_[last];
    for (auto edge = edges_.rbegin(); edge != edges_.rend() && edge->to == last; ++edge) {
      const Pose2 T_map_says = poses_[edge->from] * edge->T_from_to;
      const Eigen::Matrix3d covariance = geometry::compose_covariance(
          poses_[edge->from], Eigen::Matrix3d::Zero(), edge->T_from_to, edge->covariance);
      const Eigen::Matrix3d information = covariance.inverse();
      const Eigen::Vector3d error = geometry::difference(T_map_last, T_map_says);
      const double weight = 1.0 / (1.0 + error.dot(information * error) / 9.0);
      hessian += weight * information;
      gradient += weight * (information * error);
    }
    if (hessian.determinant() <= 0.0) return;
    const Eigen::Vector3d step = hessian.inverse() * gradient;
    T_map_last = {T_map_last.x_m - step.x(), T_map_last.y_m - step.y(),
                  geometry::wrap_angle(T_map_last.theta_rad - step.z())};
  }
}

std::size_t PoseGraph::remove_edges(EdgeKind kind, double largest_disagreement) {
  const std::size_t removed = std::erase_if(edges_, [&](const PoseGraphEdge& edge) {
    return edge.kind == kind && disagreement(edge) > largest_disagreement;
  });
  if (removed > 0) {
    links_.clear();
    link_of_.clear();
    for (const PoseGraphEdge& edge : edges_) add_to_link(edge);
  }
  return removed;
}

std::vector<UncertainPose> PoseGraph::relative_to(std::uint32_t origin) const {
  using Graph = boost::compressed_sparse_row_graph<boost::directedS, boost::no_property, Hop,
                                                   boost::no_property, std::uint32_t>;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ends;
  std::vector<Hop> hops;
  ends.reserve(2 * links_.size());
  hops.reserve(2 * links_.size());
  for (std::uint32_t k = 0; k < links_.size(); ++k) {
    const Hop hop{path_cost(links_[k].covariance), k};
    ends.emplace_back(links_[k].from, links_[k].to);
    ends.emplace_back(links_[k].to, links_[k].from);
    hops.push_back(hop);
    hops.push_back(hop);
  }
  const Graph graph(boost::edges_are_unsorted_multi_pass, ends.begin(), ends.end(), hops.begin(),
                    static_cast<std::uint32_t>(poses_.size()));
  std::vector<std::uint32_t> before(poses_.size());
  std::vector<double> cost(poses_.size());
  boost::dijkstra_shortest_paths(
      graph, origin,
      boost::predecessor_map(
          boost::make_iterator_property_map(before.begin(), get(boost::vertex_index, graph)))
          .distance_map(
              boost::make_iterator_property_map(cost.begin(), get(boost::vertex_index, graph)))
          .weight_map(get(&Hop::cost, graph)));

  // In order of cost every stop comes after the one before it on its path.
  std::vector<std::uint32_t> order(poses_.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return cost[a] < cost[b]; });
  std::vector<UncertainPose> relative(poses_.size());
  for (const std::uint32_t stop : order) {
    relative[stop].T_a_b = geometry::between(poses_[origin], poses_[stop]);
    if (stop == origin) continue;
    const std::uint32_t previous = before[stop];
    if (previous == stop) {  // not connected
      relative[stop].covariance = Eigen::Matrix3d::Identity() * 1e6;
      continue;
    }
    const Link& link = links_[link_of_.at(std::minmax(previous, stop))];
    const Pose2 T_previous_stop = geometry::between(poses_[previous], poses_[stop]);
    const Eigen::Matrix3d covariance =
        link.from == previous
            ? link.covariance
            : geometry::inverse_covariance(geometry::inverse(T_previous_stop), link.covariance);
    relative[stop].covariance = geometry::compose_covariance(
        relative[previous].T_a_b, relative[previous].covariance, T_previous_stop, covariance);
  }
  return relative;
}

}  // namespace topogeo::localization
