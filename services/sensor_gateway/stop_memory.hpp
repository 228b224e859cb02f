// Remembers halt and emergency stop in a small file, so that no restart of the gateway releases
// them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "topogeo/devices/base_interlocks.hpp"
#include "topogeo/support/record_file.hpp"

namespace topogeo::sensor_gateway {

class StopMemory {
 public:
  /// Opens or creates the file; with an empty path nothing is kept. Throws std::runtime_error
  /// naming the file if that fails.
  explicit StopMemory(const std::filesystem::path& path);

  /// The stops that hold. A damaged file counts as a halt, because a stop may have been in it.
  [[nodiscard]] const devices::HeldStops& held() const { return held_; }
  /// True if the file was damaged.
  [[nodiscard]] bool damaged() const { return damaged_; }
  /// Writes `held` if it differs from the file. Returns false if the file cannot be written: it is
  /// then damaged, and the next call tries again.
  [[nodiscard]] bool store(const devices::HeldStops& held);

 private:
  struct Record {
    std::uint64_t emergency_stop = 0;
    std::uint64_t halt = 0;
  };
  [[nodiscard]] bool write(const devices::HeldStops& held) const {
    return file_.store({std::uint64_t{held.emergency_stop}, std::uint64_t{held.halt}});
  }

  bool damaged_;  // judged before the file is created
  support::RecordFile<Record> file_;
  devices::HeldStops held_;
  bool written_ = true;  // whether the file contains held_
};

}  // namespace topogeo::sensor_gateway
