// Use of a robot's stops, in one process or as a service: start a map, continue a stored one, or
// localize in a stored map that never changes.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/match.hpp"
#include "topogeo/relocalization/map_tracker.hpp"
#include "topogeo/session/mapping_session.hpp"
#include "topogeo/slam/graph_optimization.hpp"
#include "topogeo/slam/localizer_config.hpp"
#include "topogeo/slam/slam.hpp"
#include "topogeo/slam/stored_map.hpp"

namespace topogeo::localization {

/// PoseGraphSlam or the added mode, by `config.mode`. The pool and the optimizer (see
/// PoseGraphSlam) must outlive it. Throws std::invalid_argument if the program does not have the
/// mode.
std::unique_ptr<Slam> make_slam(const LocalizerConfig& config, MatchPool& pool,
                                GraphOptimizer* optimizer = nullptr);

/// Uncertainty of a pose given by an operator: 0.3 m and 10 degrees.
Eigen::Matrix3d given_pose_covariance();

/// A stored map and its use in the session.
struct MapToUse {
  enum class Use : std::uint8_t {
    kLocalize,
    kExtendMap,
    kResumeSession  ///< like kExtendMap, and the robot starts at the last stop of the map
  };
  std::shared_ptr<const StoredMap> map;
  Use use = Use::kLocalize;
  std::optional<geometry::Pose2> T_map_start;  ///< pose of the robot at its first stop, given by an
                                               ///< operator; empty: the whole map is searched
};

class SlamSession {
 public:
  /// Begins a map. The pool and the optimizer (see PoseGraphSlam) must outlive the session.
  SlamSession(const LocalizerConfig& config, MatchPool& pool, GraphOptimizer* optimizer = nullptr);
  /// Uses a stored map. Throws like MapTracker or, to continue the map, like MappingSession.
  SlamSession(const LocalizerConfig& config, MatchPool& pool, GraphOptimizer* optimizer,
              const MapToUse& stored);

  [[nodiscard]] Slam& operator*() const { return *slam_; }
  [[nodiscard]] Slam* operator->() const { return slam_.get(); }

  /// Null if a stored map never changes.
  [[nodiscard]] MappingSession* mapping_session() const { return mapping_session_; }
  /// Follows the robot in a map; null while its stops join the map one by one.
  [[nodiscard]] MapTracker* map_tracker() const {
    return mapping_session_ != nullptr ? mapping_session_->map_tracker() : map_tracker_;
  }
  /// Whether stops join the map, now or once their pose in it is known.
  [[nodiscard]] bool mapping() const {
    return mapping_session_ != nullptr && mapping_session_->mapping();
  }

 private:
  std::unique_ptr<Slam> slam_;
  MappingSession* mapping_session_ = nullptr;  // slam_, if it is one
  MapTracker* map_tracker_ = nullptr;          // slam_, if it is one
};

}  // namespace topogeo::localization
