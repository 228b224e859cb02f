#include "pose_links.hpp"

#include <limits>

#include <Eigen/LU>
#include <boost/graph/dijkstra_shortest_paths.hpp>
#include <boost/property_map/function_property_map.hpp>

namespace topogeo::localization {

using geometry::Pose2;

namespace {

// Ends a search when all wanted stops have been reached.
struct Enough {};

constexpr double kFarAway = std::numeric_limits<double>::max();

}  // namespace

class PoseLinks::Visitor : public boost::default_dijkstra_visitor {
 public:
  Visitor(Marks& marks, const std::function<bool(std::uint32_t, double)>& visit)
      : marks_(&marks), visit_(&visit) {}

  template <class Graph>
  void discover_vertex(std::size_t stop, const Graph& /*graph*/) {
    marks_->touched.push_back(static_cast<std::uint32_t>(stop));
  }
  template <class Edge, class Graph>
  void edge_relaxed(const Edge& edge, const Graph& graph) {
    marks_->link_to[boost::target(edge, graph)] = graph[edge].value;
  }
  template <class Graph>
  void examine_vertex(std::size_t stop, const Graph& /*graph*/) {
    if (!(*visit_)(static_cast<std::uint32_t>(stop), marks_->cost[stop])) throw Enough();
  }

 private:
  Marks* marks_;
  const std::function<bool(std::uint32_t, double)>* visit_;
};

void PoseLinks::add_stop() {
  boost::add_vertex(network_);
  marks_.cost.push_back(kFarAway);
  marks_.colour.push_back(boost::white_color);
  marks_.link_to.push_back(0);
  marks_.position.push_back(0);
  marks_.wanted.push_back(0);
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

void PoseLinks::remove(std::uint32_t from, std::uint32_t to) {
  const auto found = link_of_.find({from, to});
  if (found == link_of_.end()) return;
  boost::remove_edge(from, to, network_);
  link_of_.erase(found);  // the link itself stays unused: removals are rare
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

void PoseLinks::visit_nearest(std::span<const std::uint32_t> origins,
                              const std::function<bool(std::uint32_t, double)>& visit) const {
  for (const std::uint32_t stop : marks_.touched) {
    marks_.cost[stop] = kFarAway;
    marks_.colour[stop] = boost::white_color;
  }
  marks_.touched.clear();
  const auto index = boost::get(boost::vertex_index, network_);
  const auto cost_of = [this](const Network::edge_descriptor& edge) {
    return links_[network_[edge].value].cost;
  };
  for (const std::uint32_t origin : origins) marks_.cost[origin] = 0.0;
  try {
    boost::dijkstra_shortest_paths_no_init(
        network_, origins.begin(), origins.end(), boost::dummy_property_map(),
        boost::make_iterator_property_map(marks_.cost.begin(), index),
        boost::make_function_property_map<Network::edge_descriptor>(cost_of), index, std::less<>(),
        boost::closed_plus<double>(), 0.0, Visitor(marks_, visit),
        boost::make_iterator_property_map(marks_.colour.begin(), index));
  } catch (const Enough&) {
  }
}

RelativePoses PoseLinks::relative_to(std::span<const Pose2> poses, std::uint32_t origin,
                                     std::span<const std::uint32_t> wanted, double largest_cost,
                                     std::size_t most) const {
  if (wanted.empty()) return {};
  for (const std::uint32_t stop : wanted) marks_.wanted[stop] = 1;
  std::vector<std::uint32_t> reached;  // nearest first, so that each follows its predecessor
  std::size_t left = wanted.size();
  visit_nearest({&origin, 1}, [&](std::uint32_t stop, double cost) {
    if (cost > largest_cost || reached.size() >= most) return false;
    marks_.position[stop] = static_cast<std::uint32_t>(reached.size());
    reached.push_back(stop);
    return !(marks_.wanted[stop] != 0 && --left == 0);
  });
  for (const std::uint32_t stop : wanted) marks_.wanted[stop] = 0;

  const auto previous_of = [&](std::uint32_t stop) {
    const Link& link = links_[marks_.link_to[stop]];
    return link.from == stop ? link.to : link.from;
  };
  std::vector<std::uint8_t> needed(reached.size(), 0);  // on the path to a wanted stop
  const auto is_reached = [&](std::uint32_t stop) {
    const std::uint32_t position = marks_.position[stop];
    return position < reached.size() && reached[position] == stop;
  };
  for (const std::uint32_t stop : wanted) {
    if (is_reached(stop)) needed[marks_.position[stop]] = 1;
  }
  for (std::size_t i = reached.size(); i-- > 1;) {
    if (needed[i] != 0) needed[marks_.position[previous_of(reached[i])]] = 1;
  }
  std::vector<UncertainPose> relative(reached.size());
  for (std::size_t i = 1; i < reached.size(); ++i) {
    if (needed[i] == 0) continue;
    const std::uint32_t stop = reached[i];
    const Link& link = links_[marks_.link_to[stop]];
    const std::uint32_t previous = previous_of(stop);
    const Pose2 T_previous_stop = geometry::between(poses[previous], poses[stop]);
    const Eigen::Matrix3d covariance =
        link.from == previous
            ? link.covariance
            : geometry::inverse_covariance(geometry::inverse(T_previous_stop), link.covariance);
    const UncertainPose& before = relative[marks_.position[previous]];
    relative[i] = {
        geometry::between(poses[origin], poses[stop]),
        geometry::compose_covariance(before.T_a_b, before.covariance, T_previous_stop, covariance)};
  }
  std::vector<RelativePoses::Stop> stops;
  stops.reserve(wanted.size());
  for (const std::uint32_t stop : wanted) {
    if (is_reached(stop)) stops.push_back({stop, relative[marks_.position[stop]]});
  }
  return RelativePoses(std::move(stops));
}

}  // namespace topogeo::localization
