// The contents of the telegrams of a SICK PLS laser, and of an LMS-2xx at its defaults.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/devices/sick_telegram.hpp"

namespace topogeo::devices {

/// Commands of the host; the reply's code is the command's with bit 7 set, except for a reset.
namespace pls_command {
inline constexpr std::uint8_t kReset = 0x10;
inline constexpr std::uint8_t kMode = 0x20;
inline constexpr std::uint8_t kRequestScan = 0x30;
inline constexpr std::uint8_t kRequestStatus = 0x31;
inline constexpr std::uint8_t kRequestErrors = 0x32;
}  // namespace pls_command

namespace pls_reply {
inline constexpr std::uint8_t kPowerOn = 0x90;
inline constexpr std::uint8_t kReset = 0x91;
inline constexpr std::uint8_t kNotAcknowledged = 0x92;
inline constexpr std::uint8_t kMode = 0xA0;
inline constexpr std::uint8_t kMeasuredValues = 0xB0;
inline constexpr std::uint8_t kStatus = 0xB1;
inline constexpr std::uint8_t kErrors = 0xB2;
}  // namespace pls_reply

/// First parameter of the command kMode.
enum class PlsMode : std::uint8_t {
  kInstallation = 0x00,  ///< followed by the password
  kStream = 0x24,        ///< all measured values, one scan after the other
  kOnRequest = 0x25,     ///< measured values on request only
};

/// The command that puts the sensor into `mode`; only kInstallation uses `password`.
[[nodiscard]] std::vector<std::uint8_t> pls_mode_command(PlsMode mode,
                                                         std::string_view password = {});
/// The command that changes the sensor's rate; empty for an unsupported rate.
[[nodiscard]] std::optional<std::vector<std::uint8_t>> pls_baud_command(std::uint32_t baud);
/// The rate for a parameter of kMode.
[[nodiscard]] std::optional<std::uint32_t> pls_baud_of(std::uint8_t parameter);
/// Asks for one whole scan.
[[nodiscard]] std::vector<std::uint8_t> pls_scan_request();

enum class PlsSeverity : std::uint8_t { kNone, kInfo, kWarning, kError, kFatal };

/// The byte at the end of every telegram of the sensor. Its bits are documented for the LMS; the
/// same meaning for the PLS is not confirmed on hardware.
struct PlsHealth {
  PlsSeverity severity = PlsSeverity::kNone;
  bool restarting = false;   ///< bit 5
  bool implausible = false;  ///< bit 6: the sensor calls its measured values implausible
  bool polluted = false;     ///< bit 7: the window is dirty
  bool operator==(const PlsHealth&) const = default;
};
[[nodiscard]] PlsHealth pls_health(std::uint8_t status);

/// One measured value.
struct PlsReading {
  std::uint16_t distance = 0;     ///< 0 ... 8191, in the unit of the telegram
  bool dazzled = false;           ///< the beam met glaring light
  bool warning_field = false;     ///< an object is in the warning field
  bool protective_field = false;  ///< an object is in the protective field
  bool operator==(const PlsReading&) const = default;
};
[[nodiscard]] PlsReading pls_reading(std::uint16_t word);
[[nodiscard]] std::uint16_t pls_word(const PlsReading& reading);

/// The measured values of a telegram; valid as long as the telegram. Value 0 is the rightmost.
struct PlsMeasuredValues {
  std::span<const std::uint8_t> bytes{};  ///< two for each value, low byte first
  double unit_m = 0.01;  ///< from the bits of an LMS: 1 cm, 1 mm or 10 cm; always 1 cm for a PLS
  unsigned part = 0;     ///< part of an LMS's interlaced scan; 0 for a PLS
  PlsHealth health{};
  [[nodiscard]] std::size_t size() const { return bytes.size() / 2; }
  [[nodiscard]] std::uint16_t word(std::size_t i) const {
    return static_cast<std::uint16_t>(bytes[2 * i] | bytes[2 * i + 1] << 8);
  }
};
/// Empty if the telegram has other contents.
[[nodiscard]] std::optional<PlsMeasuredValues> pls_measured_values(const SickTelegram& telegram);

/// The sensor's reply to a change of mode.
enum class PlsModeReply : std::uint8_t { kDone = 0, kRefused = 1, kFault = 2 };
/// Empty if the telegram is no reply to a change of mode; any code above 1 is a fault.
[[nodiscard]] std::optional<PlsModeReply> pls_mode_reply(const SickTelegram& telegram);

struct PlsStatusReport {
  std::string software;               ///< version, of seven characters
  std::optional<std::uint32_t> baud;  ///< the rate in use, if the report holds a known one
  PlsHealth health{};
};
[[nodiscard]] std::optional<PlsStatusReport> pls_status_report(const SickTelegram& telegram);

struct PlsError {
  PlsSeverity severity = PlsSeverity::kNone;
  std::uint8_t number = 0;  ///< by the manufacturer's list
  bool operator==(const PlsError&) const = default;
};
/// The errors in the sensor's memory, without empty places.
[[nodiscard]] std::optional<std::vector<PlsError>> pls_errors(const SickTelegram& telegram);

/// The sensor's name for itself after power-on; unprintable characters are left out.
[[nodiscard]] std::optional<std::string> pls_power_on_text(const SickTelegram& telegram);

/// Place and codes of the rate in a status report of the PLS (BeeSoft's laser server is the only
/// source; not confirmed on hardware).
inline constexpr std::size_t kPlsStatusBaudAt = 115;
[[nodiscard]] std::optional<std::uint16_t> pls_status_baud_code(std::uint32_t baud);

}  // namespace topogeo::devices
