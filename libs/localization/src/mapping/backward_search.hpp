// The beam search with backtracking behind correct_backward.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/localization/mapping/backward_correction.hpp"

namespace topogeo::localization {

class BackwardSearch {
 public:
  /// All must outlive the search; the input has been checked.
  BackwardSearch(const BackwardProblem& problem, const SolutionStore& solutions,
                 const BackwardConfig& config);

  BackwardResult run();

 private:
  /// The end of a walk: one pose, with the walk behind it through `parent`.
  struct Node {
    geometry::Pose2 T_first_pose;
    double fitness = 0.0;      // summed so far
    double rank = 0.0;         // what it may come to at the first pose
    std::uint32_t parent = 0;  // index into the nodes of the pose after; of a candidate at the last
  };
  /// What is known of one pose of the loop.
  struct Level {
    geometry::Pose2 T_first_expected;
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
    Eigen::Matrix3d information = Eigen::Matrix3d::Identity();
    Eigen::Vector3d half_width = Eigen::Vector3d::Zero();
    /// From this pose back to the one before.
    struct Step {
      geometry::Pose2 T_this_previous;
      Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  // in the frame of this pose
      double fitness = 0.0;
    };
    std::vector<Step> steps;
    std::vector<std::uint32_t> seen_by;  // later poses whose maps overlap with its, ascending
    bool is_via = false;                 // of a candidate
    std::vector<Node> nodes;
    std::vector<Node> waiting;  // best first
    std::size_t next_waiting = 0;
  };
  /// A pose drawn towards where it is expected.
  struct Draw {
    geometry::Pose2 T_first_pose;
    double distance2 = 0.0;  // squared deviations from where it was
  };

  void describe_levels(const SolutionStore& solutions);
  void seed();
  void expand(std::uint32_t k);
  void offer(Level& level, const geometry::Pose2& T_first_pose, double fitness,
             std::uint32_t parent);
  /// Takes walks out of those that wait at pose k; false when none is left.
  bool take(std::uint32_t k);
  [[nodiscard]] bool still_overlaps(std::uint32_t k, const Node& node) const;
  [[nodiscard]] Draw draw(const Level& level, const geometry::Pose2& T_first_pose,
                          const Eigen::Matrix3d& covariance) const;
  void collect(BackwardResult& result) const;

  const BackwardProblem& problem_;
  BackwardConfig config_;
  std::uint32_t last_;
  std::vector<Level> levels_;  // index as in BackwardProblem::poses; 0 is not searched
  std::vector<StepOption> first_step_;
  double mean_fitness_ = 0.0;  // of the best solution of a step
  std::uint64_t expanded_ = 0;
  std::uint64_t work_ = 0;
};

}  // namespace topogeo::localization
