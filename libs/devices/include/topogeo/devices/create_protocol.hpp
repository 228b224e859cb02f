// Open Interface of an iRobot Create 2 or Roomba of the series 500 to 800: orders of one byte and
// their data, and a stream of sensor packets with a checksum.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "topogeo/devices/serial_driver.hpp"

namespace topogeo::devices {

namespace create_order {
inline constexpr std::uint8_t kStart = 128;  ///< the interface, in passive mode; the motors stop
inline constexpr std::uint8_t kSafe = 131;   ///< gives control of the motors
inline constexpr std::uint8_t kDriveDirect = 145;
inline constexpr std::uint8_t kStream = 148;
}  // namespace create_order

enum class CreateMode : std::uint8_t {
  kOff,
  kPassive,  ///< it reports, and obeys no speeds
  kSafe,     ///< it obeys, and falls to passive at a wheel drop, a cliff or a charger
  kFull      ///< it obeys whatever happens; never asked for here
};
/// A Roomba 690 reports the number of its mode as one more than the specification.
inline constexpr std::uint8_t kMostCreateMode = 4;

/// The contents of a frame of the stream.
struct CreateReport {
  bool bump_right = false;
  bool bump_left = false;
  bool drop_right = false;
  bool drop_left = false;
  std::array<bool, 4> cliffs{};  ///< left, front left, front right, right
  std::uint8_t charging =
      0;  ///< 0: not, 1: reconditioning, 2: full, 3: trickle, 4: waits, 5: fault
  std::uint16_t millivolts = 0;
  std::uint16_t charge_mah = 0;          ///< of the battery, mAh
  std::uint16_t capacity_mah = 0;        ///< of the battery when it is full; 0: not known
  bool charger = false;                  ///< is plugged in
  bool dock = false;                     ///< stands on it
  std::uint8_t mode = 0;                 ///< of CreateMode, or one more; at most kMostCreateMode
  std::array<std::uint16_t, 2> ticks{};  ///< left and right, forward; wrap
  bool operator==(const CreateReport&) const = default;
};

inline constexpr std::uint8_t kCreateStreamHeader = 19;
/// Bytes of a frame of the stream, with header, length and checksum.
inline constexpr std::size_t kCreateFrame_bytes = 34;
/// mm/s of a wheel.
inline constexpr int kCreateFastest = 500;

/// Time between two frames, ms: the device's 15, or a multiple if the line is too slow for it.
[[nodiscard]] std::uint32_t create_period_ms(const LineSettings& line);

/// The order that starts the stream.
[[nodiscard]] std::vector<std::uint8_t> create_stream_request();
/// Speeds of the wheels in mm/s, positive ahead; both are cut by the same share if one is faster
/// than kCreateFastest.
[[nodiscard]] std::vector<std::uint8_t> create_drive(double left_mmps, double right_mmps);
/// A frame, as the device sends it.
[[nodiscard]] std::vector<std::uint8_t> to_bytes(const CreateReport& report);
/// Low byte of the sum of all bytes of a frame without its checksum, negated: with it the sum is 0.
[[nodiscard]] std::uint8_t create_checksum(std::span<const std::uint8_t> frame);

struct CreateCounters {
  std::uint64_t noise_bytes = 0;   ///< outside of frames
  std::uint64_t bad_checksum = 0;  ///< frames with the right packets and a wrong sum
  std::uint64_t bad_fields = 0;    ///< frames with a right sum and a value that no device sends
  bool operator==(const CreateCounters&) const = default;
};

/// Finds frames of the requested packets in a stream of bytes that is cut anywhere.
class CreateDecoder {
 public:
  void push(std::span<const std::uint8_t> bytes);
  [[nodiscard]] std::optional<CreateReport> next();
  void clear() { bytes_.clear(); }
  [[nodiscard]] const CreateCounters& counters() const { return counters_; }

 private:
  std::deque<std::uint8_t> bytes_;
  CreateCounters counters_;
};

}  // namespace topogeo::devices
