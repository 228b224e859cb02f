// Decides when the pose of a robot that is followed in a map is certain enough for its drive to
// join that map (docs/algorithms.md, "A map that goes on").
#pragma once

#include <cstdint>

#include "topogeo/relocalization/map_tracker.hpp"

namespace topogeo::localization {

class PlaceConfirmation {
 public:
  /// Starts again for another drive or another tracker.
  void begin() { *this = {}; }
  /// Like begin(), and the pose of the tracker counts as found by a search.
  void begin_searched() {
    *this = {};
    searched_ = true;
  }

  /// Call after each stop of the tracker. True if the last stop is tracked and matched, and, after
  /// a search, enough stops before it as well: at a first look a room of another building can
  /// resemble one of the map.
  bool add(const MapTracker& tracker);

  /// Successive tracked stops, including the last one.
  [[nodiscard]] std::uint32_t stops() const { return stops_; }
  /// Distance driven over these stops.
  [[nodiscard]] double distance_m() const { return distance_m_; }
  /// Share of the expected common view that contradicts, mean over these stops; 0 without any.
  [[nodiscard]] double contradicted() const { return stops_ == 0 ? 0.0 : contradiction_ / stops_; }

 private:
  bool searched_ = false;  // the pose comes from a search
  std::uint32_t stops_ = 0;
  double distance_m_ = 0.0;
  double contradiction_ = 0.0;  // sum over these stops
};

/// Whether the stop is tracked by accepted matches and not contradicted by the rest of its view.
bool tracked_well(const MapTracker& tracker);

}  // namespace topogeo::localization
