// Where the odometry is, in a small file that outlives a gateway that is killed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "topogeo/devices/base_odometer.hpp"
#include "topogeo/support/file_descriptor.hpp"

namespace topogeo::sensor_gateway {

struct RememberedOdometry {
  devices::OdometerState state;
  std::uint64_t epoch = 0;
  std::uint64_t next_sequence = 0;  ///< of scans
  std::int64_t last_stamp_ns = 0;   ///< of what was published
};

/// One record that is overwritten in place. It reaches the file with each call, which the loss of
/// the process does not take away; it is not forced to disk, since after a loss of power the base
/// counts anew as well.
class OdometryMemory {
 public:
  /// An empty path: nothing is kept. Throws std::runtime_error naming the file when it cannot be
  /// opened or made.
  explicit OdometryMemory(const std::filesystem::path& path);

  /// What was stored last; empty when that is nothing, damaged, or from before the machine was
  /// started.
  [[nodiscard]] std::optional<RememberedOdometry> load() const;
  /// What cannot be written is lost: the odometry then begins anew.
  void store(const RememberedOdometry& odometry) const;

 private:
  support::FileDescriptor file_;
};

}  // namespace topogeo::sensor_gateway
