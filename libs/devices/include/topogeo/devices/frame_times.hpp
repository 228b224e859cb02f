// Times of frames that a device sends in a steady rhythm, without a clock: late arrivals are taken
// back to the rhythm, which may be a little slower than stated.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

namespace topogeo::devices {

class FrameTimes {
 public:
  /// `period_ns`: as stated, > 0. The true one may be up to a tenth longer.
  explicit FrameTimes(std::int64_t period_ns) : period_ns_(period_ns) {}

  /// Host time of a frame, for one that was read at `now_ns` with `behind` others behind it. Each
  /// result is later than the one before.
  std::int64_t next(std::size_t behind, std::int64_t now_ns);

 private:
  std::int64_t period_ns_;
  std::optional<std::int64_t> last_ns_;
};

}  // namespace topogeo::devices
