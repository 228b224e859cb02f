// Queue of local maps for the localizer: each map once, session by session in the order of their
// numbers, until the stream ends.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "topogeo/topomap/local_map.hpp"

namespace topogeo::localizer {

class StopQueue {
 public:
  using MapPointer = std::shared_ptr<const topomap::LocalMap>;

  enum class Arrival : std::uint8_t {
    kNew,       ///< to be added
    kRepeated,  ///< taken already: a reader gets a map again when its writer comes back
    kOtherRun,  ///< a different map of a stop already taken
  };
  /// A stop taken very long ago is kRepeated whatever its content.
  [[nodiscard]] Arrival arrival(const topomap::StopId& stop, std::uint64_t content_hash) const;

  /// Continues after that stop of an existing map. Call it before the first take().
  void start_after(const topomap::StopId& stop) { last_ = stop; }

  /// Replaces a map of the same stop that has not been taken.
  void add(MapPointer map);
  /// The next local map of the current session, or else the first stop of a later session; null
  /// when neither has arrived.
  MapPointer take();
  /// The stop that take() waits for although later ones of its session are here. It will not arrive
  /// any more, because its sender sends them in order.
  [[nodiscard]] std::optional<topomap::StopId> missing() const;
  /// The stop that take() waits for although the stream has ended: it may be under way, or its
  /// sender has ended before sending it.
  [[nodiscard]] std::optional<topomap::StopId> missing_at_end() const;
  /// Begins a new session with the first of its stops that is here, and returns that stop.
  topomap::StopId begin_late(std::uint64_t session);
  /// The last session of the stream has `maps` local maps.
  void end_at(std::uint64_t maps) { maps_in_session_ = maps; }

  [[nodiscard]] std::size_t waiting() const { return waiting_.size(); }
  /// Local maps taken so far.
  [[nodiscard]] std::size_t taken() const { return taken_; }
  /// All maps of an ended stream have been taken.
  [[nodiscard]] bool finished() const;

 private:
  MapPointer take(const topomap::StopId& stop);
  /// First stop of a session.
  [[nodiscard]] topomap::StopId first_of(std::uint64_t session) const;
  [[nodiscard]] bool gap_at(const topomap::StopId& stop) const;
  /// Drops the rest of a session when another one begins.
  void end_session(std::uint64_t session);

  std::map<topomap::StopId, MapPointer> waiting_;
  std::vector<std::uint64_t> sessions_;              // in order of arrival
  std::map<std::uint64_t, std::uint32_t> first_;     // first numbers, by session; 0 for all others
  std::map<topomap::StopId, std::uint64_t> hashes_;  // of recent maps of the current session
  std::set<std::uint64_t> over_;                     // sessions
  std::size_t taken_ = 0;
  std::optional<topomap::StopId> last_;  // taken, or already in the map
  std::optional<std::uint64_t> maps_in_session_;
};

}  // namespace topogeo::localizer
