// Data sets of SICK safety scanners (nanoScan3, microScan3, outdoorScan3), their fragments in UDP
// datagrams, and the CoLa 2 telegrams that ask for them.
//
// Source: SICK, "Technical information: microScan3, outdoorScan3, nanoScan3, data output via UDP
// and TCP/IP" (8022708), and the maker's driver sick_safetyscanners for the header of a datagram.
// CoLa 2 is highest byte first; all fields inside of it and of data sets are lowest byte first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

namespace topogeo::devices {

/// One beam of a data set.
struct SafetyBeam {
  std::uint16_t distance = 0;  ///< millimetres, times SafetyScan::factor
  std::uint8_t status = 0;     ///< bits kSafetyValid ...
};
inline constexpr unsigned kSafetyValid = 1U << 0U;
inline constexpr unsigned kSafetyInfinite = 1U << 1U;
inline constexpr unsigned kSafetyGlare = 1U << 2U;
inline constexpr unsigned kSafetyDirty = 1U << 4U;  ///< contamination
inline constexpr unsigned kSafetyDirtyWarning = 1U << 5U;

/// Device status of a data set. A bit of a path is 1 if its output is on, which means that its
/// field is free; bit 0 is path 1.
struct SafetyState {
  bool standby = false;
  bool contamination_warning = false;
  bool contamination_error = false;
  bool reference_contour = false;  ///< not in its tolerance
  bool manipulated = false;
  std::uint32_t safe_paths = 0;
  std::uint32_t other_paths = 0;  ///< the same paths, not safe
  bool application_error = false;
  bool device_error = false;
};

struct SafetyScan {
  std::uint32_t serial_number = 0;
  std::uint8_t channel = 0;
  std::uint32_t sequence = 0;  ///< of the channel
  std::uint32_t scan = 0;
  std::uint32_t time_ms = 0;  ///< of the day, when the data set was made
  std::optional<SafetyState> state;
  std::uint16_t factor = 1;
  std::uint16_t scan_time_ms = 0;  ///< a turn
  std::int32_t first = 0;          ///< angle in kSafetyDegree; 90 degrees are ahead
  std::int32_t step = 0;
  std::vector<SafetyBeam> beams;
  /// Beams that lie in the field of a path, for each path of the data set.
  std::vector<std::size_t> intruding;
};
inline constexpr double kSafetyDegree = 4'194'304.0;

/// Empty if a block lies outside of the data, or the data have no beams or no angles.
[[nodiscard]] std::optional<SafetyScan> safety_scan(std::span<const std::uint8_t> data);
/// The data set; `intruding` as that many first beams of each path.
[[nodiscard]] std::vector<std::uint8_t> safety_data(const SafetyScan& scan);

inline constexpr std::size_t kSafetyHead = 24;        ///< bytes of a datagram's header
inline constexpr std::size_t kSafetyFragment = 1436;  ///< data in a datagram of an emulator
/// The datagrams of a data set, in order.
[[nodiscard]] std::vector<std::vector<std::uint8_t>> safety_datagrams(
    std::span<const std::uint8_t> data, std::uint32_t identification);

/// Puts data sets together from fragments in any order.
class SafetyAssembler {
 public:
  /// The data set that this datagram completes.
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> add(
      std::span<const std::uint8_t> datagram);
  void clear();
  [[nodiscard]] std::uint64_t foreign() const { return foreign_; }
  [[nodiscard]] std::uint64_t repeated() const { return repeated_; }
  /// Data sets of which fragments are missing.
  [[nodiscard]] std::uint64_t incomplete() const { return incomplete_; }

 private:
  struct Part {
    std::uint32_t identification = 0;
    std::vector<std::uint8_t> data;
    std::vector<bool> here;
    std::size_t missing = 0;
  };
  [[nodiscard]] Part* part_of(std::uint32_t identification, std::size_t size);

  std::deque<Part> parts_;          // oldest first
  std::deque<std::uint32_t> done_;  // of the last complete ones
  std::uint64_t foreign_ = 0;
  std::uint64_t repeated_ = 0;
  std::uint64_t incomplete_ = 0;
};

/// A telegram of CoLa 2.
struct Cola2Telegram {
  std::uint32_t session = 0;
  std::uint16_t request = 0;
  char type = 0;
  char mode = 0;
  std::vector<std::uint8_t> data;
};
[[nodiscard]] std::vector<std::uint8_t> cola2_bytes(const Cola2Telegram& telegram);

/// Where and what a channel sends.
struct SafetyOutput {
  std::uint8_t channel = 0;
  std::uint8_t interface = 4;
  std::uint32_t address = 0;  ///< of the receiver; 127.0.0.1 is 0x7F000001
  std::uint16_t port = 0;
};
inline constexpr std::uint16_t kSafetyConfigure = 0x00B0;  ///< method
[[nodiscard]] std::vector<std::uint8_t> safety_configuration(const SafetyOutput& output);
/// Empty for the data of another method.
[[nodiscard]] std::optional<SafetyOutput> safety_output(std::span<const std::uint8_t> data);

/// Finds telegrams in a stream of bytes that is cut anywhere.
class Cola2Reader {
 public:
  [[nodiscard]] std::vector<Cola2Telegram> read(std::span<const std::uint8_t> bytes);
  void clear() { buffer_.clear(); }
  [[nodiscard]] std::uint64_t noise_bytes() const { return noise_bytes_; }

 private:
  std::vector<std::uint8_t> buffer_;
  std::uint64_t noise_bytes_ = 0;
};

}  // namespace topogeo::devices
