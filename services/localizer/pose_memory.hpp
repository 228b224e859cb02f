// Where a robot was at its last stop in a finished map, in a small file that outlives a localizer
// that is killed.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>

#include "topogeo/localization/mapping/stored_map.hpp"
#include "topogeo/localization/tracking/map_localizer.hpp"
#include "topogeo/support/record_file.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::localizer {

struct RememberedPlace {
  topomap::StopId stop;
  localization::LastPlace place;
};

class PoseMemory {
 public:
  /// Places are those of `map`: of another one nothing is remembered. Throws std::runtime_error
  /// naming the file when it cannot be opened or made.
  PoseMemory(const std::filesystem::path& path, const localization::StoredMap& map);

  /// What was stored last; empty when that is nothing, damaged, or a place in another map.
  [[nodiscard]] std::optional<RememberedPlace> load() const;
  void store(const RememberedPlace& remembered) const;
  /// Where the robot is is not known any more.
  void forget() const { file_.store(Record{}); }

 private:
  /// As it lies in the file, for this machine alone. Zeros: nothing.
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
  std::uint64_t map_;  // which one
};

}  // namespace topogeo::localizer
