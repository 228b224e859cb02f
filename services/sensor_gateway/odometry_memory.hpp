// Where the odometry is, in a small file that outlives a gateway that is killed.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>

#include "topogeo/devices/base_odometer.hpp"
#include "topogeo/support/record_file.hpp"

namespace topogeo::sensor_gateway {

struct RememberedOdometry {
  devices::OdometerState state;
  std::uint64_t epoch = 0;
  std::uint64_t next_sequence = 0;  ///< of scans
  std::int64_t last_stamp_ns = 0;   ///< of what was published
};

/// As it lies in the file, for this machine alone.
struct OdometryRecord {
  std::uint64_t boot = 0;  ///< of the machine, which the steady clock begins anew with
  std::array<std::uint32_t, devices::kMcpFields> fields{};
  std::uint64_t mask = 0;
  std::int64_t arrival_ns = 0;
  double x_m = 0.0;
  double y_m = 0.0;
  double theta_rad = 0.0;
  std::uint64_t epoch = 0;
  std::uint64_t next_sequence = 0;
  std::int64_t last_stamp_ns = 0;
};

/// It is not forced to disk, since after a loss of power the base counts anew as well.
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
  support::RecordFile<OdometryRecord> file_;
};

}  // namespace topogeo::sensor_gateway
