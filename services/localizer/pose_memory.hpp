// Remembers a robot's last stop in a finished map, in a small file that survives a killed
// localizer.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>

#include "topogeo/relocalization/map_tracker.hpp"
#include "topogeo/slam/stored_map.hpp"
#include "topogeo/support/record_file.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::localizer {

struct RememberedPlace {
  topomap::StopId stop;
  localization::LastPlace place;
};

class PoseMemory {
 public:
  /// Places refer to `map`: load() ignores a place in another map. Throws std::runtime_error naming
  /// the file when it cannot be opened or made.
  PoseMemory(const std::filesystem::path& path, const localization::StoredMap& map);

  /// The place stored last; empty when there is none, it is damaged, or it is in another map.
  [[nodiscard]] std::optional<RememberedPlace> load() const;
  void store(const RememberedPlace& remembered) const;
  /// The robot's place is no longer known.
  void forget() const { static_cast<void>(file_.store(Record{})); }

 private:
  /// Layout of the file, for this machine alone. All zeros: no place.
  struct Record {
    std::uint64_t map = 0;
    std::uint64_t session = 0;
    std::uint64_t number = 0;
    std::uint64_t odometry_epoch = 0;
    std::array<double, 3> T_odom_robot{};
    std::array<double, 3> T_map_robot{};
    std::array<double, 9> covariance{};
  };

  support::RecordFile<Record> file_;
  std::uint64_t map_;  // identifies its frame
};

}  // namespace topogeo::localizer
