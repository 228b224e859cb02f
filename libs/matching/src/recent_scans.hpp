// The last key scans of a track as one reference for the next scan, in the frame of the newest.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/coarse_search.hpp"
#include "topogeo/matching/match_features.hpp"

namespace topogeo::localization {

class RecentScans {
 public:
  static constexpr std::size_t kKept = 5;  ///< two or three metres of path

  /// Adds a key scan with its pose in the frame of the track; the oldest one goes. Throws
  /// std::invalid_argument like make_reference().
  void add(std::shared_ptr<const MatchFeatures> features, const geometry::Pose2& T_track_robot);

  /// The view of the newest key scan, with the surfaces that only the others saw.
  [[nodiscard]] const Reference& reference() const { return reference_; }
  [[nodiscard]] const geometry::Pose2& T_track_newest() const { return keys_.back().T_track_robot; }

  /// Places of `features` within a window around a pose in the frame of the newest key scan, best
  /// first.
  std::vector<geometry::Pose2> search(const MatchFeatures& features, const CoarseWindow& window);

 private:
  struct Key {
    std::shared_ptr<const MatchFeatures> features;
    geometry::Pose2 T_track_robot;
  };

  std::deque<Key> keys_;
  Reference reference_;
  std::optional<CoarseMap> coarse_;  // of the reference, on demand
};

}  // namespace topogeo::localization
