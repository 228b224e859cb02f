// Output of an emulated device: its bytes leave in sequence at the device's rate, and a host with
// other settings reads them as other bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "topogeo/devices/serial_driver.hpp"

namespace topogeo::simulation {

class SerialOutput {
 public:
  /// Sends `bytes` with `line` from `start_ns` on, or after all earlier bytes have left, whichever
  /// is later. Returns when the last of them will have left.
  std::int64_t send(std::vector<std::uint8_t> bytes, const devices::LineSettings& line,
                    std::int64_t start_ns);

  /// When everything sent so far has left; in the past while the line is idle.
  [[nodiscard]] std::int64_t free_ns() const { return free_ns_; }

  /// Bytes that left by `now_ns` and were not taken yet, as read by a host with the settings
  /// `host`. With settings other than the sender's these are other bytes, and also another number
  /// of them if the rates differ; the same bytes are always misread in the same way.
  [[nodiscard]] std::vector<std::uint8_t> take(const devices::LineSettings& host,
                                               std::int64_t now_ns);

  /// The device lost its power: nothing more leaves, and sent bytes are lost.
  void clear();

 private:
  struct Message {
    devices::LineSettings line;
    std::int64_t start_ns = 0;
    std::vector<std::uint8_t> bytes;
    std::size_t taken = 0;
  };
  static void read_part(const Message& message, std::size_t end, const devices::LineSettings& host,
                        std::vector<std::uint8_t>& out);

  std::deque<Message> messages_;
  std::int64_t free_ns_ = 0;
};

}  // namespace topogeo::simulation
