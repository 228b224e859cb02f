#include "pose_links.hpp"

#include <functional>
#include <limits>

#include <Eigen/LU>
#include <boost/graph/dijkstra_shortest_paths.hpp>
#include <boost/property_map/function_property_map.hpp>

namespace topogeo::localization {

using geometry::Pose2;

namespace {

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

void PoseLinks::add_stop() {
  boost::add_vertex(network_);
}

void PoseLinks::add(const PoseGraphEdge& edge, const Eigen::Matrix3d& covariance) {
  const auto next = static_cast<std::uint32_t>(links_.size());
  const auto [found, fresh] = link_of_.try_emplace({edge.from, edge.to}, next);
  if (fresh) {
    Link& link = links_.emplace_back();
    link.from = edge.from;
    link.to = edge.to;
    boost::add_edge(edge.from, edge.to, LinkIndex{next}, network_);
  }
  Link& link = links_[found->second];
  link.information += covariance.inverse();
  link.covariance = link.information.inverse();
  link.cost = PoseGraph::path_cost(link.covariance);
}

void PoseLinks::clear() {
  const std::size_t stops = boost::num_vertices(network_);
  links_.clear();
  link_of_.clear();
  network_.clear();
  for (std::size_t i = 0; i < stops; ++i) boost::add_vertex(network_);
}

std::vector<std::pair<std::uint32_t, Eigen::Matrix3d>> PoseLinks::links_to(
    std::uint32_t stop) const {
  std::vector<std::pair<std::uint32_t, Eigen::Matrix3d>> found;
  const auto [first, last] = boost::out_edges(stop, network_);
  for (auto edge = first; edge != last; ++edge) {
    const Link& link = links_[network_[*edge].value];
    if (link.to == stop) found.emplace_back(link.from, link.covariance);
  }
  return found;
}

std::vector<UncertainPose> PoseLinks::relative_to(std::span<const Pose2> poses,
                                                  std::uint32_t origin,
                                                  const PoseGraph::Reach& reach) const {
  std::vector<std::uint32_t> link_to(poses.size());
  std::vector<double> cost(poses.size(), std::numeric_limits<double>::max());
  std::vector<boost::default_color_type> colour(poses.size(), boost::white_color);
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
  std::vector<UncertainPose> relative(poses.size());
  for (std::uint32_t stop = 0; stop < poses.size(); ++stop) {
    relative[stop].covariance = Eigen::Matrix3d::Identity() * PoseGraph::kUnreached_m2;
    if (stop < reach.first_stop) continue;
    relative[stop].T_a_b = geometry::between(poses[origin], poses[stop]);
  }
  // Every stop comes after the one before it on its path.
  for (const std::uint32_t stop : order) {
    relative[stop].T_a_b = geometry::between(poses[origin], poses[stop]);
    if (stop == origin) {
      relative[stop].covariance.setZero();
      continue;
    }
    const Link& link = links_[link_to[stop]];
    const std::uint32_t previous = link.from == stop ? link.to : link.from;
    const Pose2 T_previous_stop = geometry::between(poses[previous], poses[stop]);
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
