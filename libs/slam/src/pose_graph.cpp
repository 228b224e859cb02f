#include "topogeo/slam/pose_graph.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <string>

#include <Eigen/LU>

#include "least_squares.hpp"
#include "pose_links.hpp"
#include "step_sums.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

// Typical distance of the features that a robot matches: a heading error moves them by this lever.
constexpr double kLeverArm_m = 5.0;

}  // namespace

PoseGraph::PoseGraph()
    : links_(std::make_unique<PoseLinks>()),
      calibrated_links_(std::make_unique<PoseLinks>()),
      step_sums_(std::make_unique<StepSums>()) {}
PoseGraph::PoseGraph(const PoseGraph& other)
    : poses_(other.poses_),
      edges_(other.edges_),
      edges_at_(other.edges_at_),
      links_(std::make_unique<PoseLinks>(*other.links_)),
      calibrated_links_(std::make_unique<PoseLinks>(*other.calibrated_links_)),
      step_sums_(std::make_unique<StepSums>()) {}
PoseGraph::PoseGraph(PoseGraph&&) noexcept = default;
PoseGraph& PoseGraph::operator=(const PoseGraph& other) {
  return *this = PoseGraph(other);
}
PoseGraph& PoseGraph::operator=(PoseGraph&&) noexcept = default;
PoseGraph::~PoseGraph() = default;

std::uint32_t PoseGraph::add_pose(const Pose2& T_map_robot) {
  poses_.push_back(T_map_robot);
  edges_at_.emplace_back();
  links_->add_stop();
  calibrated_links_->add_stop();
  return static_cast<std::uint32_t>(poses_.size() - 1);
}

void PoseGraph::add_edge(const PoseGraphEdge& edge) {
  if (edge.from >= edge.to || edge.to >= poses_.size()) {
    throw std::invalid_argument(
        "pose graph: an edge must lead from an earlier stop to a later one");
  }
  const auto index = static_cast<std::uint32_t>(edges_.size());
  edges_.push_back(edge);
  edges_at_[edge.from].push_back(index);
  edges_at_[edge.to].push_back(index);
  link(edge);
}

void PoseGraph::link(const PoseGraphEdge& edge) {
  if (edge.from + 1 == edge.to) step_sums_->changed(edge.to);
  links_->add(edge, edge.covariance);
  calibrated_links_->add(edge, edge.for_predictions());
}

double PoseGraph::disagreement(const PoseGraphEdge& edge) const {
  const Pose2 now = geometry::between(poses_[edge.from], poses_[edge.to]);
  return geometry::squared_mahalanobis(geometry::difference(now, edge.T_from_to), edge.covariance);
}

void PoseGraph::place_last_pose() {
  const auto last = static_cast<std::uint32_t>(poses_.size() - 1);
  step_sums_->changed(last);
  constexpr int kIterations = 5;
  for (int k = 0; k < kIterations; ++k) {
    Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    Pose2& T_map_last = poses_[last];
    for (auto edge = edges_.rbegin(); edge != edges_.rend() && edge->to == last; ++edge) {
      const Pose2 T_map_measured = poses_[edge->from] * edge->T_from_to;
      const Eigen::Matrix3d covariance = geometry::compose_covariance(
          poses_[edge->from], Eigen::Matrix3d::Zero(), edge->T_from_to, edge->covariance);
      const Eigen::Matrix3d information = covariance.inverse();
      const Eigen::Vector3d error = geometry::difference(T_map_last, T_map_measured);
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

OptimizationSummary PoseGraph::optimize() {
  step_sums_->all_changed();
  std::vector<std::uint8_t> held(poses_.size(), 0);
  if (!held.empty()) held.front() = 1;
  return least_squares(poses_, held, edges_);
}

void PoseGraph::correct_step(std::uint32_t stop, const Pose2& T_before_stop) {
  for (const std::uint32_t i : edges_at_.at(stop)) {
    PoseGraphEdge& edge = edges_[i];
    if (edge.kind == EdgeKind::kOdometry && edge.to == stop) edge.T_from_to = T_before_stop;
  }
}

void PoseGraph::remove_edges(std::span<const PoseGraphEdge> like) {
  const auto removed =
      std::stable_partition(edges_.begin(), edges_.end(), [&](const PoseGraphEdge& edge) {
        return std::none_of(like.begin(), like.end(), [&](const PoseGraphEdge& other) {
          return edge.kind == other.kind && edge.from == other.from && edge.to == other.to;
        });
      });
  if (removed == edges_.end()) return;
  edges_.erase(removed, edges_.end());
  for (std::vector<std::uint32_t>& at : edges_at_) at.clear();
  for (std::uint32_t i = 0; i < edges_.size(); ++i) {
    edges_at_[edges_[i].from].push_back(i);
    edges_at_[edges_[i].to].push_back(i);
  }
  for (const PoseGraphEdge& gone : like) {
    step_sums_->changed(gone.to);
    links_->remove(gone.from, gone.to);
    calibrated_links_->remove(gone.from, gone.to);
    for (const std::uint32_t i : edges_at_[gone.from]) {
      if (edges_[i].from == gone.from && edges_[i].to == gone.to) link(edges_[i]);
    }
  }
}

void PoseGraph::move(std::span<const std::uint32_t> stops, std::span<const Pose2> T_map_robot) {
  if (stops.empty() || stops.back() >= poses_.size() || stops.size() != T_map_robot.size()) {
    throw std::invalid_argument("pose graph: " + std::to_string(T_map_robot.size()) +
                                " poses for " + std::to_string(stops.size()) + " of " +
                                std::to_string(poses_.size()) + " stops");
  }
  const std::uint32_t last = stops.back();
  const Pose2 T_last_map = geometry::inverse(poses_[last]);
  for (std::size_t i = 0; i < stops.size(); ++i) {
    if (poses_[stops[i]] == T_map_robot[i]) continue;
    poses_[stops[i]] = T_map_robot[i];
    step_sums_->changed(stops[i]);
  }
  for (std::uint32_t stop = last + 1; stop < poses_.size(); ++stop) {
    poses_[stop] = poses_[last] * (T_last_map * poses_[stop]);
    step_sums_->changed(stop);
  }
}

double PoseGraph::path_cost(const Eigen::Matrix3d& c) {
  return c(0, 0) + c(1, 1) + kLeverArm_m * kLeverArm_m * c(2, 2);
}

std::vector<std::pair<std::uint32_t, Eigen::Matrix3d>> PoseGraph::links_to(
    std::uint32_t stop) const {
  return links_->links_to(stop);
}

std::vector<std::uint32_t> PoseGraph::stops_near(const Eigen::Vector2d& place_m, double radius_m,
                                                 std::size_t most, std::uint32_t end) const {
  std::vector<std::pair<double, std::uint32_t>> near;
  // A linear scan takes a nanosecond per stop: no index is worth its upkeep while poses move.
  for (std::uint32_t stop = 0; stop < end; ++stop) {
    const double square_m2 = (poses_[stop].position_m() - place_m).squaredNorm();
    if (square_m2 <= radius_m * radius_m) near.emplace_back(square_m2, stop);
  }
  if (near.size() > most) {
    std::nth_element(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(most), near.end());
    near.resize(most);
  }
  std::vector<std::uint32_t> stops;
  stops.reserve(near.size());
  for (const auto& [square_m2, stop] : near) stops.push_back(stop);
  std::sort(stops.begin(), stops.end());
  return stops;
}

RelativePoses PoseGraph::relative_to(std::uint32_t origin, std::span<const std::uint32_t> wanted,
                                     double largest_cost) const {
  return links_->relative_to(poses_, origin, wanted, largest_cost, kAllStops);
}

std::vector<UncertainPose> PoseGraph::relative_to(std::uint32_t origin) const {
  std::vector<UncertainPose> relative;
  relative.reserve(poses_.size());
  for (const Pose2& pose : poses_) {
    relative.push_back(
        {geometry::between(poses_[origin], pose), Eigen::Matrix3d::Identity() * kUnreached_m2});
  }
  std::vector<std::uint32_t> all(poses_.size());
  std::iota(all.begin(), all.end(), 0U);
  const RelativePoses reached = relative_to(origin, all);
  for (const RelativePoses::Stop& stop : reached.stops()) {
    relative[stop.id] = stop.T_origin_stop;
  }
  return relative;
}

RelativePoses PoseGraph::predict_from(std::uint32_t origin, std::span<const std::uint32_t> wanted,
                                      double largest_cost, std::size_t most) const {
  return calibrated_links_->relative_to(poses_, origin, wanted, largest_cost, most);
}

void PoseGraph::visit_nearest(std::span<const std::uint32_t> origins,
                              const std::function<bool(std::uint32_t, double)>& visit) const {
  links_->visit_nearest(origins, visit);
}

UncertainPose PoseGraph::along_path(std::uint32_t from, std::uint32_t to) const {
  if (from > to) return inverse(along_path(to, from));
  const auto step = [this](std::uint32_t stop) -> const Eigen::Matrix3d& {
    return calibrated_links_->covariance(stop - 1, stop);
  };
  return step_sums_->along(poses_, step, from, to);
}

}  // namespace topogeo::localization
