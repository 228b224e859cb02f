// Local maps on their way into the localizer: each once, in the order of their ids, until the
// stream ends.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "topogeo/topomap/local_map.hpp"

namespace topogeo::localizer {

class StopQueue {
 public:
  using MapPointer = std::shared_ptr<const topomap::LocalMap>;

  enum class Arrival : std::uint8_t {
    kNew,       ///< to be added
    kRepeated,  ///< has been taken already: a reader gets a map again when its writer comes back
    kOtherRun,  ///< another map of an id that has been taken
  };
  [[nodiscard]] Arrival arrival(std::uint32_t id, std::uint64_t content_hash) const;

  /// Replaces a map of that id that has not been taken.
  void add(MapPointer map);
  /// The next local map; null when it has not come yet.
  MapPointer take();
  /// So many local maps are in the whole stream.
  void end_at(std::uint64_t maps) { maps_in_stream_ = maps; }

  /// Local maps taken so far.
  [[nodiscard]] std::size_t taken() const { return hashes_.size(); }
  /// All of an ended stream have been taken.
  [[nodiscard]] bool finished() const {
    return maps_in_stream_ && hashes_.size() >= *maps_in_stream_;
  }

 private:
  std::map<std::uint32_t, MapPointer> waiting_;  // by id
  std::vector<std::uint64_t> hashes_;            // of those taken; index: id
  std::optional<std::uint64_t> maps_in_stream_;
};

}  // namespace topogeo::localizer
