// What a robot does with its stops, in one process or as a service: begins a map, continues a
// stored one, or localizes in a stored map that stays as it is for good.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/localization/mapping/graph_optimization.hpp"
#include "topogeo/localization/mapping/localizer_config.hpp"
#include "topogeo/localization/mapping/slam.hpp"
#include "topogeo/localization/mapping/stored_map.hpp"
#include "topogeo/localization/matching/match.hpp"
#include "topogeo/localization/session/mapping_session.hpp"
#include "topogeo/localization/tracking/map_localizer.hpp"

namespace topogeo::localization {

/// How well a pose that a person gives is known: 0.3 m and 10 degrees.
Eigen::Matrix3d given_pose_covariance();

/// A stored map, and what the session is to do with it.
struct MapToUse {
  enum class Use : std::uint8_t {
    kLocalize,
    kContinue,
    kGoOn  ///< the same, and the robot goes on from the last stop of the map
  };
  std::shared_ptr<const StoredMap> map;
  Use use = Use::kLocalize;
  std::optional<geometry::Pose2> T_map_start;  ///< of the robot at its first stop, as a person
                                               ///< gives it; none: the whole map is searched
};

class SlamSession {
 public:
  /// Begins a map. The pool and the optimizer (see Localizer) must outlive the session.
  SlamSession(const LocalizerConfig& config, MatchPool& pool, GraphOptimizer* optimizer = nullptr);
  /// Uses a stored map. Throws like MapLocalizer or, when it is continued, like MappingSession.
  SlamSession(const LocalizerConfig& config, MatchPool& pool, GraphOptimizer* optimizer,
              const MapToUse& stored);

  [[nodiscard]] Slam& operator*() const { return *slam_; }
  [[nodiscard]] Slam* operator->() const { return slam_.get(); }

  /// Null when a stored map stays as it is for good.
  [[nodiscard]] MappingSession* mapping_session() const { return mapping_session_; }
  /// What follows the robot in a map; null while its stops become part of it one by one.
  [[nodiscard]] MapLocalizer* follower() const {
    return mapping_session_ != nullptr ? mapping_session_->follower() : map_localizer_;
  }
  /// Stops become part of the map, now or when their place in it is known.
  [[nodiscard]] bool mapping() const {
    return mapping_session_ != nullptr && mapping_session_->mapping();
  }

 private:
  std::unique_ptr<Slam> slam_;
  MappingSession* mapping_session_ = nullptr;  // slam_, if it is one
  MapLocalizer* map_localizer_ = nullptr;      // slam_, if it is one
};

}  // namespace topogeo::localization
