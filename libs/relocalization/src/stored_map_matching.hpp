// Matches stops of a drive with the stops of a stored map that does not change.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/match.hpp"
#include "topogeo/matching/match_features.hpp"
#include "topogeo/matching/odometry_model.hpp"
#include "topogeo/relocalization/global_localization.hpp"
#include "topogeo/slam/candidate_choice.hpp"
#include "topogeo/slam/localizer_config.hpp"
#include "topogeo/slam/match_requests.hpp"
#include "topogeo/slam/stored_map.hpp"
#include "topogeo/topomap/local_map.hpp"

#include "drive_window.hpp"

namespace topogeo::localization {

/// A stop of a drive, prepared for comparison with stored stops.
struct DriveStop {
  std::shared_ptr<const topomap::LocalMap> map;  ///< with its id in the pool
  MatchFeatures features;                        ///< of the scan
  bool follows = false;                          ///< there is a previous stop
  DriveStep step;                                ///< from the previous stop
};

class StoredMapMatching {
 public:
  /// The pool must outlive this. Throws like GlobalLocalizer.
  StoredMapMatching(const LocalizerConfig& config, std::shared_ptr<const StoredMap> map,
                    MatchPool& pool);

  /// Registers the `number`th stop of the drive with the pool, under one of the ids after those of
  /// the stored maps, and matches it with the previous stops. `T_odom_last`: the odometry at the
  /// previous stop, if any.
  DriveStop add(const topomap::LocalMap& map, std::uint32_t number,
                const std::optional<geometry::Pose2>& T_odom_last);

  /// The stored stops that should look most alike from a pose, without direct neighbours along the
  /// drive that mapped them; their ids are indices.
  [[nodiscard]] std::vector<MatchCandidate> candidates(const DriveStop& stop,
                                                       const UncertainPose& T_map_robot,
                                                       std::size_t count) const;
  /// The `count` best places in the whole map for the view of the last metres before this stop. The
  /// pool searches.
  std::vector<Climbed> search(const DriveStop& stop, std::size_t count);
  /// A task for the stop and a stored one, by index. A search space wider than the configured limit
  /// is cut, because the only alternative is to search the whole map.
  MatchTask task(const DriveStop& stop, std::size_t stored, const UncertainPose& T_map_robot);
  std::vector<MatchResult> run(std::span<const MatchTask> tasks) { return requests_.run(tasks); }
  /// T_map_robot by a match with a stored stop.
  [[nodiscard]] UncertainPose measured(std::size_t stored, const MatchResult& result) const;

  [[nodiscard]] std::size_t stored_stops() const { return map_->maps.size(); }
  [[nodiscard]] const GlobalLocalizer& places() const { return places_; }
  [[nodiscard]] MatchRequests& requests() { return requests_; }
  [[nodiscard]] const MatchRequests& requests() const { return requests_; }

 private:
  LocalizerConfig config_;
  std::shared_ptr<const StoredMap> map_;
  GlobalLocalizer places_;
  PlaceQuery query_;  // for the last metres
  MatchRequests requests_;
  DriveWindow window_;
};

}  // namespace topogeo::localization
