#include "topogeo/devices/pls_messages.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace topogeo::devices {
namespace {

constexpr std::uint16_t kDistanceMask = 0x1FFF;
constexpr std::uint16_t kDazzled = 1U << 13;
constexpr std::uint16_t kWarningField = 1U << 14;
constexpr std::uint16_t kProtectiveField = 1U << 15;

constexpr std::uint8_t kScanWhole = 0x01;

constexpr std::size_t kCount_bytes = 2;
constexpr unsigned kValuesMask = 0x3FF;
constexpr unsigned kPartShift = 11;
constexpr unsigned kPartMask = 0x3;
constexpr unsigned kUnitShift = 14;
constexpr std::array<double, 4> kUnits_m{0.01, 0.001, 0.1, 0.01};

constexpr std::size_t kSoftware_bytes = 7;

/// Parameters of the mode command.
constexpr std::array<std::pair<std::uint32_t, std::uint8_t>, 4> kBaudParameters{
    {{38400, 0x40}, {19200, 0x41}, {9600, 0x42}, {500'000, 0x48}}};
/// Codes of the rates in a status report.
constexpr std::array<std::pair<std::uint32_t, std::uint16_t>, 3> kBaudCodes{
    {{38400, 0x8019}, {19200, 0x8033}, {9600, 0x8067}}};

std::string printable(std::span<const std::uint8_t> bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes) {
    if (byte >= ' ' && byte <= '~') text.push_back(static_cast<char>(byte));
  }
  return text;
}

PlsSeverity severity(unsigned bits) {
  return static_cast<PlsSeverity>(std::min(bits, static_cast<unsigned>(PlsSeverity::kFatal)));
}

}  // namespace

std::vector<std::uint8_t> pls_mode_command(PlsMode mode, std::string_view password) {
  std::vector<std::uint8_t> data{static_cast<std::uint8_t>(mode)};
  data.insert(data.end(), password.begin(), password.end());
  return sick_command(pls_command::kMode, data);
}

std::optional<std::vector<std::uint8_t>> pls_baud_command(std::uint32_t baud) {
  for (const auto& [rate, parameter] : kBaudParameters) {
    if (rate == baud) return sick_command(pls_command::kMode, std::span(&parameter, 1));
  }
  return std::nullopt;
}

std::optional<std::uint32_t> pls_baud_of(std::uint8_t parameter) {
  for (const auto& [rate, known] : kBaudParameters) {
    if (known == parameter) return rate;
  }
  return std::nullopt;
}

std::vector<std::uint8_t> pls_scan_request() {
  return sick_command(pls_command::kRequestScan, std::span(&kScanWhole, 1));
}

PlsHealth pls_health(std::uint8_t status) {
  return {severity(status & 0x07U), (status & 0x20U) != 0, (status & 0x40U) != 0,
          (status & 0x80U) != 0};
}

PlsReading pls_reading(std::uint16_t word) {
  return {static_cast<std::uint16_t>(word & kDistanceMask), (word & kDazzled) != 0,
          (word & kWarningField) != 0, (word & kProtectiveField) != 0};
}

std::uint16_t pls_word(const PlsReading& reading) {
  unsigned word = reading.distance & kDistanceMask;
  if (reading.dazzled) word |= kDazzled;
  if (reading.warning_field) word |= kWarningField;
  if (reading.protective_field) word |= kProtectiveField;
  return static_cast<std::uint16_t>(word);
}

std::optional<PlsMeasuredValues> pls_measured_values(const SickTelegram& telegram) {
  if (telegram.code != pls_reply::kMeasuredValues || telegram.data.size() < kCount_bytes) {
    return std::nullopt;
  }
  const unsigned count = telegram.data[0] | static_cast<unsigned>(telegram.data[1]) << 8;
  PlsMeasuredValues values;
  values.bytes = telegram.data.subspan(kCount_bytes);
  if (values.bytes.size() != std::size_t{2} * (count & kValuesMask)) return std::nullopt;
  values.part = count >> kPartShift & kPartMask;
  values.unit_m = kUnits_m[count >> kUnitShift];
  values.health = pls_health(telegram.status);
  return values;
}

std::optional<PlsModeReply> pls_mode_reply(const SickTelegram& telegram) {
  if (telegram.code != pls_reply::kMode || telegram.data.empty()) return std::nullopt;
  if (telegram.data[0] > 1) return PlsModeReply::kFault;
  return static_cast<PlsModeReply>(telegram.data[0]);
}

std::optional<PlsStatusReport> pls_status_report(const SickTelegram& telegram) {
  if (telegram.code != pls_reply::kStatus) return std::nullopt;
  PlsStatusReport report;
  const std::span<const std::uint8_t> data = telegram.data;
  report.software = printable(data.first(std::min(kSoftware_bytes, data.size())));
  report.health = pls_health(telegram.status);
  if (data.size() < kPlsStatusBaudAt + 2) return report;
  const unsigned code = data[kPlsStatusBaudAt] | static_cast<unsigned>(data[kPlsStatusBaudAt + 1])
                                                     << 8;
  for (const auto& [rate, known] : kBaudCodes) {
    if (known == code) report.baud = rate;
  }
  return report;
}

std::optional<std::vector<PlsError>> pls_errors(const SickTelegram& telegram) {
  if (telegram.code != pls_reply::kErrors) return std::nullopt;
  std::vector<PlsError> errors;
  for (std::size_t i = 0; i + 1 < telegram.data.size(); i += 2) {
    const PlsError error{severity(telegram.data[i]), telegram.data[i + 1]};
    if (error.severity != PlsSeverity::kNone) errors.push_back(error);
  }
  return errors;
}

std::optional<std::string> pls_power_on_text(const SickTelegram& telegram) {
  if (telegram.code != pls_reply::kPowerOn) return std::nullopt;
  return printable(telegram.data);
}

std::optional<std::uint16_t> pls_status_baud_code(std::uint32_t baud) {
  for (const auto& [rate, code] : kBaudCodes) {
    if (rate == baud) return code;
  }
  return std::nullopt;
}

}  // namespace topogeo::devices
