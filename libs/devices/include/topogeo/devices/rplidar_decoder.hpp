// Finds the answers of a RPLIDAR in its bytes: descriptors with their data, then the samples of a
// scan.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "topogeo/devices/rplidar_protocol.hpp"

namespace topogeo::devices {

/// Counts of dropped bytes and packets.
struct RpCounters {
  std::uint64_t noise_bytes = 0;
  std::uint64_t bad_checksum = 0;
  bool operator==(const RpCounters&) const = default;
};

class RpDecoder {
 public:
  struct Answer {
    RpDescriptor descriptor;
    std::vector<std::uint8_t> data;  ///< empty: the descriptor of a scan, whose samples follow
    std::size_t bytes_since = 0;     ///< that were received after the answer
    bool contiguous = true;          ///< nothing was dropped since the last answer
  };

  void push(std::span<const std::uint8_t> bytes) {
    buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
  }
  /// The next answer; empty: more bytes are needed.
  [[nodiscard]] std::optional<Answer> next();
  /// A request was sent that ends the scan: drops its samples and waits for a descriptor.
  void expect_descriptor();
  [[nodiscard]] const RpCounters& counters() const { return counters_; }

 private:
  [[nodiscard]] std::optional<Answer> next_descriptor();
  [[nodiscard]] std::optional<Answer> next_sample();
  [[nodiscard]] bool is_sample(std::span<const std::uint8_t> bytes);
  void drop_byte();
  [[nodiscard]] std::vector<std::uint8_t> front(std::size_t count) const;
  [[nodiscard]] Answer take(const RpDescriptor& descriptor, std::size_t header, std::size_t data);

  std::deque<std::uint8_t> buffer_;
  std::optional<RpDescriptor> scan_;  // whose samples follow
  bool contiguous_ = true;
  RpCounters counters_;
};

}  // namespace topogeo::devices
