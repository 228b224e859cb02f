// Local maps on their way into the localizer: each once, session by session in the order of their
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
    kRepeated,  ///< has been taken already: a reader gets a map again when its writer comes back
    kOtherRun,  ///< another map of a stop that has been taken
  };
  /// One that was taken very long ago is kRepeated whatever its content.
  [[nodiscard]] Arrival arrival(const topomap::StopId& stop, std::uint64_t content_hash) const;

  /// Goes on after that stop of a map that is there already. Before the first is taken.
  void start_after(const topomap::StopId& stop) { last_ = stop; }

  /// Replaces a map of that stop that has not been taken.
  void add(MapPointer map);
  /// The next local map: of the session that is on, or else the first stop of one that came later;
  /// null when neither has come yet.
  MapPointer take();
  /// The stop that take() waits for although later ones of its session are here: its sender sends
  /// them in order, so that it does not come any more.
  [[nodiscard]] std::optional<topomap::StopId> missing() const;
  /// The stop that take() waits for although the stream has ended: it may be under way, or whoever
  /// sent it has ended before it came.
  [[nodiscard]] std::optional<topomap::StopId> missing_at_end() const;
  /// A session that has not begun begins with the first of its stops that is here, which is
  /// returned.
  topomap::StopId begin_late(std::uint64_t session);
  /// So many local maps are in the session that the stream ends with.
  void end_at(std::uint64_t maps) { maps_in_session_ = maps; }

  [[nodiscard]] std::size_t waiting() const { return waiting_.size(); }
  /// Local maps taken so far.
  [[nodiscard]] std::size_t taken() const { return taken_; }
  /// All of an ended stream have been taken.
  [[nodiscard]] bool finished() const;

 private:
  MapPointer take(const topomap::StopId& stop);
  /// The stop that a session begins with.
  [[nodiscard]] topomap::StopId first_of(std::uint64_t session) const;
  [[nodiscard]] bool gap_at(const topomap::StopId& stop) const;
  /// Another session is on: what is left of this one is not wanted any more.
  void end_session(std::uint64_t session);

  std::map<topomap::StopId, MapPointer> waiting_;
  std::vector<std::uint64_t> sessions_;              // in the order in which they came
  std::map<std::uint64_t, std::uint32_t> first_;     // numbers, by session; others begin with 0
  std::map<topomap::StopId, std::uint64_t> hashes_;  // of the last taken of the session that is on
  std::set<std::uint64_t> over_;                     // sessions
  std::size_t taken_ = 0;
  std::optional<topomap::StopId> last_;  // taken, or there before
  std::optional<std::uint64_t> maps_in_session_;
};

}  // namespace topogeo::localizer
