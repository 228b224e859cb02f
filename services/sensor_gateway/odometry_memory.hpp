// Remembers the state of the odometry in a small file that survives a killed gateway.
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
  std::int64_t last_stamp_ns = 0;   ///< of the last published message
};

/// Layout of the file, for this machine alone.
struct OdometryRecord {
  std::uint64_t boot = 0;  ///< of the machine, with which the steady clock restarts
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

/// Not forced to disk, because the base also restarts its count after a loss of power.
class OdometryMemory {
 public:
  /// With an empty path nothing is kept. Throws std::runtime_error naming the file when it cannot
  /// be opened or made.
  explicit OdometryMemory(const std::filesystem::path& path);

  /// The state stored last; empty when there is none, it is damaged, or it is from before the last
  /// boot.
  [[nodiscard]] std::optional<RememberedOdometry> load() const;
  /// A failure to write is ignored: the odometry then begins a new epoch.
  void store(const RememberedOdometry& odometry) const;

 private:
  support::RecordFile<OdometryRecord> file_;
};

}  // namespace topogeo::sensor_gateway
