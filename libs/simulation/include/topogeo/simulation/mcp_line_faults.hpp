// Faults of the line of an emulated RWI base, on demand: what happens to the bytes that it sends.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "topogeo/support/random.hpp"

namespace topogeo::simulation {

class McpLineFaults {
 public:
  /// `seed`: of where faults hit.
  explicit McpLineFaults(std::uint64_t seed) : random_(seed) {}

  /// One bit of each of the next reports is wrong; in the binary dialect it may be the checksum's.
  void corrupt(unsigned reports) { corrupt_ = reports; }
  /// The next reports end somewhere in the middle.
  void truncate(unsigned reports) { truncate_ = reports; }
  /// Nothing is sent.
  void set_silent(bool silent) { silent_ = silent; }

  [[nodiscard]] bool silent() const { return silent_; }
  /// What arrives of a report; it must not be empty.
  void damage(std::vector<std::uint8_t>& report);
  /// Bytes that mean nothing.
  [[nodiscard]] std::vector<std::uint8_t> garbage(std::size_t bytes);

 private:
  support::Random random_;
  unsigned corrupt_ = 0;
  unsigned truncate_ = 0;
  bool silent_ = false;
};

}  // namespace topogeo::simulation
