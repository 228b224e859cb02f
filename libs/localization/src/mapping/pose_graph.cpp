#include "topogeo/localization/mapping/pose_graph.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include <Eigen/LU>

#include "pose_links.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

// What a robot matches by is seen about this far away: so much a standard deviation of heading
// moves it.
constexpr double kLeverArm_m = 5.0;

}  // namespace

PoseGraph::PoseGraph()
    : links_(std::make_unique<PoseLinks>()), calibrated_links_(std::make_unique<PoseLinks>()) {}
PoseGraph::PoseGraph(const PoseGraph& other)
    : poses_(other.poses_),
      edges_(other.edges_),
      links_(std::make_unique<PoseLinks>(*other.links_)),
      calibrated_links_(std::make_unique<PoseLinks>(*other.calibrated_links_)),
      step_sums_(other.step_sums_) {}
PoseGraph::PoseGraph(PoseGraph&&) noexcept = default;
PoseGraph& PoseGraph::operator=(const PoseGraph& other) {
  return *this = PoseGraph(other);
}
PoseGraph& PoseGraph::operator=(PoseGraph&&) noexcept = default;
PoseGraph::~PoseGraph() = default;

std::uint32_t PoseGraph::add_pose(const Pose2& T_map_robot) {
  poses_.push_back(T_map_robot);
  links_->add_stop();
  calibrated_links_->add_stop();
  return static_cast<std::uint32_t>(poses_.size() - 1);
}

void PoseGraph::add_edge(const PoseGraphEdge& edge) {
  if (edge.from >= edge.to || edge.to >= poses_.size()) {
    throw std::invalid_argument(
        "pose graph: an edge must lead from an earlier stop to a later one");
  }
  edges_.push_back(edge);
  if (edge.from + 1 == edge.to && step_sums_.size() > edge.to) step_sums_.resize(edge.to);
  links_->add(edge, edge.covariance);
  calibrated_links_->add(edge, edge.for_predictions());
}

double PoseGraph::disagreement(const PoseGraphEdge& edge) const {
  const Pose2 now = geometry::between(poses_[edge.from], poses_[edge.to]);
  return geometry::squared_mahalanobis(geometry::difference(now, edge.T_from_to), edge.covariance);
}

void PoseGraph::place_last_pose() {
  const auto last = static_cast<std::uint32_t>(poses_.size() - 1);
  if (step_sums_.size() > last) step_sums_.resize(last);
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
  step_sums_.clear();
  links_->clear();
  calibrated_links_->clear();
  for (const PoseGraphEdge& edge : edges_) {
    if (edge.from + 1 == edge.to && step_sums_.size() > edge.to) step_sums_.resize(edge.to);
    links_->add(edge, edge.covariance);
    calibrated_links_->add(edge, edge.for_predictions());
  }
}

void PoseGraph::move(std::span<const Pose2> T_map_robot) {
  if (T_map_robot.empty() || T_map_robot.size() > poses_.size()) {
    throw std::invalid_argument("pose graph: " + std::to_string(T_map_robot.size()) +
                                " poses for " + std::to_string(poses_.size()) + " stops");
  }
  step_sums_.clear();
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

std::vector<std::pair<std::uint32_t, Eigen::Matrix3d>> PoseGraph::links_to(
    std::uint32_t stop) const {
  return links_->links_to(stop);
}

std::vector<UncertainPose> PoseGraph::relative_to(std::uint32_t origin, const Reach& reach) const {
  return links_->relative_to(poses_, origin, reach);
}

UncertainPose PoseGraph::along_path(std::uint32_t from, std::uint32_t to) const {
  if (from > to) return inverse(along_path(to, from));
  if (step_sums_.empty()) step_sums_.emplace_back(Eigen::Matrix3d::Zero());
  while (step_sums_.size() <= to) {
    const auto stop = static_cast<std::uint32_t>(step_sums_.size());
    const Pose2& before = poses_[stop - 1];
    const Pose2& at = poses_[stop];
    // The error of the step, in the frame of the stop before, turned into the map and moved to its
    // origin: whatever turns at the stop shifts the origin.
    const geometry::SinCos r = geometry::sincos(before.theta_rad);
    Eigen::Matrix3d to_origin;
    to_origin << r.cos, -r.sin, at.y_m, r.sin, r.cos, -at.x_m, 0.0, 0.0, 1.0;
    step_sums_.emplace_back(step_sums_.back() + to_origin *
                                                    calibrated_links_->covariance(stop - 1, stop) *
                                                    to_origin.transpose());
  }
  const geometry::SinCos r = geometry::sincos(poses_[from].theta_rad);
  Eigen::Matrix3d turn;
  turn << r.cos, r.sin, 0.0, -r.sin, r.cos, 0.0, 0.0, 0.0, 1.0;
  Eigen::Matrix3d at_stop = Eigen::Matrix3d::Identity();
  at_stop(0, 2) = -poses_[to].y_m;
  at_stop(1, 2) = poses_[to].x_m;
  const Eigen::Matrix3d from_origin = turn * at_stop;
  return {geometry::between(poses_[from], poses_[to]),
          from_origin * (step_sums_[to] - step_sums_[from]) * from_origin.transpose()};
}

std::vector<UncertainPose> PoseGraph::predict_from(std::uint32_t origin, const Reach& reach) const {
  return calibrated_links_->relative_to(poses_, origin, reach);
}

}  // namespace topogeo::localization
