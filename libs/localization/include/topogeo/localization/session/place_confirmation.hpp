// When a robot that is followed in a map is where the follower has it, for certain enough to let
// its drive become part of that map (docs/algorithms.md, "A map that goes on").
#pragma once

#include <cstdint>

#include "topogeo/localization/tracking/map_localizer.hpp"

namespace topogeo::localization {

class PlaceConfirmation {
 public:
  /// Another drive, or another follower.
  void begin() { *this = {}; }
  /// The same, and wherever that has the robot counts as found by a search.
  void begin_searched() {
    *this = {};
    searched_ = true;
  }

  /// After each stop that the follower got. True when the last one is tracked and matched, and so
  /// were enough stops before it where the place was found by a search: in one look a room of
  /// another building can look like one of the map.
  bool add(const MapLocalizer& follower);

  /// Tracked in succession, the last one included.
  [[nodiscard]] std::uint32_t stops() const { return stops_; }
  /// Driven to them.
  [[nodiscard]] double distance_m() const { return distance_m_; }
  /// Of what should look alike, the share that does not; mean over them, 0 without any.
  [[nodiscard]] double contradicted() const { return stops_ == 0 ? 0.0 : contradiction_ / stops_; }

 private:
  bool searched_ = false;  // the place is known by a search
  std::uint32_t stops_ = 0;
  double distance_m_ = 0.0;
  double contradiction_ = 0.0;  // sum over them
};

/// The stop is tracked by accepted matches, and not contradicted by what else it should show.
bool tracked_well(const MapLocalizer& follower);

}  // namespace topogeo::localization
