// Faults of the line of an emulated RWI base, on demand: damages the bytes that it sends.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "topogeo/support/random.hpp"

namespace topogeo::simulation {

class McpLineFaults {
 public:
  /// `seed`: of the places of faults.
  explicit McpLineFaults(std::uint64_t seed) : random_(seed) {}

  /// Flips one bit in each of the next reports; in the binary dialect it may be the checksum's.
  void corrupt(unsigned reports) { corrupt_ = reports; }
  /// Cuts the next reports off somewhere in the middle.
  void truncate(unsigned reports) { truncate_ = reports; }
  /// Suppresses all output.
  void set_silent(bool silent) { silent_ = silent; }

  [[nodiscard]] bool silent() const { return silent_; }
  /// Applies the pending faults to a report, which must not be empty.
  void damage(std::vector<std::uint8_t>& report);
  /// Random bytes.
  [[nodiscard]] std::vector<std::uint8_t> garbage(std::size_t bytes);

 private:
  support::Random random_;
  unsigned corrupt_ = 0;
  unsigned truncate_ = 0;
  bool silent_ = false;
};

}  // namespace topogeo::simulation
