// The stops of a recording with their true poses, and the tasks for matches between them.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/matching/match_features.hpp"
#include "topogeo/matching/matcher.hpp"
#include "topogeo/pipeline/config.hpp"
#include "topogeo/slam/pose_graph_slam.hpp"

#include "recordings.hpp"

namespace topogeo::bench {

class MatchingRun {
 public:
  MatchingRun(const Recording& recording, const pipeline::Config& config);

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::size_t size() const { return maps_.size(); }
  [[nodiscard]] const topomap::LocalMap& map(std::size_t stop) const { return *maps_[stop]; }
  [[nodiscard]] const localization::MatchFeatures& features(std::size_t stop) const {
    return features_[stop];
  }

  /// True pose of one stop in the frame of another; empty unless the reference knows both.
  [[nodiscard]] std::optional<geometry::Pose2> truth(std::size_t a, std::size_t b) const;

  /// Raw odometry of a later stop in the frame of an earlier one.
  [[nodiscard]] localization::UncertainPose odometry(std::size_t earlier, std::size_t later) const;

  /// The same by the scan tracker, which compares each scan with the stop before it.
  [[nodiscard]] geometry::Pose2 tracked(std::size_t earlier, std::size_t later) const;

  /// Share of the points of one stop that another stop has in view when it is at `T_viewer_seen`.
  [[nodiscard]] double in_view(std::size_t viewer, std::size_t seen,
                               const geometry::Pose2& T_viewer_seen, double tolerance_m) const;

  /// The localizer's task for a comparison of two stops.
  [[nodiscard]] localization::MatchTask task(
      std::size_t reference, std::size_t query,
      const localization::UncertainPose& T_reference_query) const;

  localization::Matcher& matcher() { return matcher_; }

 private:
  std::string name_;
  localization::LocalizerConfig config_;
  std::vector<std::shared_ptr<const topomap::LocalMap>> maps_;
  std::vector<std::uint64_t> hashes_;
  std::vector<localization::MatchFeatures> features_;
  std::vector<std::optional<geometry::Pose2>> T_world_robot_;
  localization::Matcher matcher_;
};

/// How far a relative pose is from the true one.
struct PoseError {
  double m = 0.0;
  double rad = 0.0;
  /// One number for both: a radian counts like a metre.
  [[nodiscard]] double together() const { return m + rad; }
};
PoseError error_of(const geometry::Pose2& estimate, const geometry::Pose2& truth);

}  // namespace topogeo::bench
