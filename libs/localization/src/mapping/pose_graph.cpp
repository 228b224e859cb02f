#include "topogeo/localization/mapping/pose_graph.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>

#include <Eigen/LU>
#include <boost/graph/dijkstra_shortest_paths.hpp>
#include <boost/property_map/function_property_map.hpp>

namespace topogeo::localization {
namespace {

using geometry::Pose2;

// One standard deviation of heading moves what is seen at this distance.
constexpr double kLeverArm_m = 5.0;

// Ends a search when all that was asked for has been reached.
struct Enough {};

class ReachVisitor : public boost::default_dijkstra_visitor {
 public:
  ReachVisitor(const std::vector<double>& cost, const PoseGraph::Reach& reach,
               std::vector<std::uint32_t>& order, std::vector<std::uint32_t>& link_to)
      : cost_(&cost),
        reach_(reach),
        order_(&order),
        link_to_(&link_to),
        wanted_(cost.size() - reach.first_stop) {}

  template <class Edge, class Graph>
  void edge_relaxed(const Edge& edge, const Graph& graph) {
    (*link_to_)[boost::target(edge, graph)] = graph[edge].value;
  }

  template <class Graph>
  void examine_vertex(std::size_t stop, const Graph& /*graph*/) {
    if ((*cost_)[stop] > reach_.largest_cost) throw Enough();
    order_->push_back(static_cast<std::uint32_t>(stop));
    if (stop >= reach_.first_stop && --wanted_ == 0) throw Enough();
  }

 private:
  const std::vector<double>* cost_;
  PoseGraph::Reach reach_;
  std::vector<std::uint32_t>* order_;    // of the stops reached, nearest first
  std::vector<std::uint32_t>* link_to_;  // by which each is reached
  std::size_t wanted_;
};

}  // namespace

std::uint32_t PoseGraph::add_pose(const Pose2& T_map_robot) {
  poses_.push_back(T_map_robot);
  boost::add_vertex(network_);
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
  const auto next = static_cast<std::uint32_t>(links_.size());
  const auto [found, fresh] = link_of_.try_emplace({edge.from, edge.to}, next);
  if (fresh) {
    Link& link = links_.emplace_back();
    link.from = edge.from;
    link.to = edge.to;
    boost::add_edge(edge.from, edge.to, LinkIndex{next}, network_);
  }
  Link& link = links_[found->second];
  link.information += edge.covariance.inverse();
  link.covariance = link.information.inverse();
  link.cost = path_cost(link.covariance);
}

std::vector<std::pair<std::uint32_t, Eigen::Matrix3d>> PoseGraph::links_to(
    std::uint32_t stop) const {
  std::vector<std::pair<std::uint32_t, Eigen::Matrix3d>> found;
  const auto [first, last] = boost::out_edges(stop, network_);
  for (auto edge = first; edge != last; ++edge) {
    const Link& link = links_[network_[*edge].value];
    if (link.to == stop) found.emplace_back(link.from, link.covariance);
  }
  return found;
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

std::vector<PoseGraphEdge> PoseGraph::remove_edges(EdgeKind kind, double largest_disagreement) {
  const auto kept =
      std::stable_partition(edges_.begin(), edges_.end(), [&](const PoseGraphEdge& edge) {
        return edge.kind != kind || disagreement(edge) <= largest_disagreement;
      });
  std::vector<PoseGraphEdge> removed(kept, edges_.end());
  edges_.erase(kept, edges_.end());
  if (!removed.empty()) rebuild_links();
  return removed;
}

void PoseGraph::remove_edges(std::span<const PoseGraphEdge> like) {
  const std::size_t removed = std::erase_if(edges_, [&](const PoseGraphEdge& edge) {
    return std::any_of(like.begin(), like.end(), [&](const PoseGraphEdge& other) {
      return edge.kind == other.kind && edge.from == other.from && edge.to == other.to;
    });
  });
  if (removed > 0) rebuild_links();
}

void PoseGraph::rebuild_links() {
  links_.clear();
  link_of_.clear();
  network_.clear();
  for (std::size_t i = 0; i < poses_.size(); ++i) boost::add_vertex(network_);
  for (const PoseGraphEdge& edge : edges_) add_to_link(edge);
}

void PoseGraph::move(std::span<const Pose2> T_map_robot) {
  if (T_map_robot.empty() || T_map_robot.size() > poses_.size()) {
    throw std::invalid_argument("pose graph: " + std::to_string(T_map_robot.size()) +
                                " poses for " + std::to_string(poses_.size()) + " stops");
  }
  const std::size_t last = T_map_robot.size() - 1;
  const Pose2 T_last_map = geometry::inverse(poses_[last]);
  std::copy(T_map_robot.begin(), T_map_robot.end(), poses_.begin());
  for (std::size_t i = last + 1; i < poses_.size(); ++i) {
    poses_[i] = poses_[last] * (T_last_map * poses_[i]);
  }
}

double PoseGraph::path_cost(const Eigen::Matrix3d& c) {
  return c(0, 0) + c(1, 1) + kLeverArm_m * kLeverArm_m * c(2, 2);
}

std::vector<UncertainPose> PoseGraph::relative_to(std::uint32_t origin, const Reach& reach) const {
  std::vector<std::uint32_t> link_to(poses_.size());
  std::vector<double> cost(poses_.size(), std::numeric_limits<double>::max());
  std::vector<boost::default_color_type> colour(poses_.size(), boost::white_color);
  const auto index = boost::get(boost::vertex_index, network_);
  const auto cost_of = [this](const Network::edge_descriptor& edge) {
    return links_[network_[edge].value].cost;
  };
  cost[origin] = 0.0;
  std::vector<std::uint32_t> order;
  try {
    boost::dijkstra_shortest_paths_no_init(
        network_, origin, boost::dummy_property_map(),
        boost::make_iterator_property_map(cost.begin(), index),
        boost::make_function_property_map<Network::edge_descriptor>(cost_of), index, std::less<>(),
        boost::closed_plus<double>(), 0.0, ReachVisitor(cost, reach, order, link_to),
        boost::make_iterator_property_map(colour.begin(), index));
  } catch (const Enough&) {
  }
  std::vector<UncertainPose> relative(poses_.size());
  for (std::uint32_t stop = 0; stop < poses_.size(); ++stop) {
    relative[stop].covariance = Eigen::Matrix3d::Identity() * kUnreached_m2;
    if (stop < reach.first_stop) continue;
    relative[stop].T_a_b = geometry::between(poses_[origin], poses_[stop]);
  }
  // Every stop comes after the one before it on its path.
  for (const std::uint32_t stop : order) {
    relative[stop].T_a_b = geometry::between(poses_[origin], poses_[stop]);
    if (stop == origin) {
      relative[stop].covariance.setZero();
      continue;
    }
    const Link& link = links_[link_to[stop]];
    const std::uint32_t previous = link.from == stop ? link.to : link.from;
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
