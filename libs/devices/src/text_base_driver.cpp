#include "topogeo/devices/text_base_driver.hpp"

#include <cmath>

namespace topogeo::devices {
namespace {

constexpr std::uint16_t kTextBumper = 1;

WheelUnits text_units(const TextBaseSettings& text) {
  return {.ticks_per_m = text.ticks_per_m, .track_m = text.track_m};
}

}  // namespace

TextBaseDriver::TextBaseDriver(const BaseSettings& settings)
    : TwoWheelDriver(settings, text_units(settings.text)) {}

void TextBaseDriver::write_line(const std::string& body) {
  const std::string line = text_base_line(body);
  write({line.begin(), line.end()});
}

void TextBaseDriver::hear(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  for (const std::string& body : reader_.read(bytes)) {
    if (const auto message = text_base_message(body)) {
      obey(*message, now_ns);
    } else {
      ++bad_fields_;
    }
  }
}

void TextBaseDriver::obey(const TextBaseMessage& message, std::int64_t now_ns) {
  if (message.hello) {
    if (message.hello->version != kTextBaseVersion) {
      refuse("the base speaks version " + std::to_string(message.hello->version) +
             " of the line protocol: expected " + std::to_string(kTextBaseVersion));
      return;
    }
    greet(now_ns);
  }
  if (message.battery && runs()) {
    set_battery(1e-3 * message.battery->millivolts, message.battery->percent);
  }
  if (!message.report) return;
  const TextBaseReport& report = *message.report;
  WheelReport wheels{.time = report.time_ms};
  for (std::size_t i = 0; i < 2; ++i) wheels.ticks[i] = static_cast<std::uint32_t>(report.ticks[i]);
  if (settings().text.gyro && report.turn_mradps) wheels.turn_radps = 1e-3 * *report.turn_mradps;
  Signs signs{.watchdog = report.watchdog,
              .bumpers = report.bumper ? kTextBumper : std::uint16_t{0}};
  if (report.emergency_stop) signs.emergency_stop = "";
  take(wheels, signs, now_ns);
}

void TextBaseDriver::ask(unsigned /*attempt*/, std::int64_t /*now_ns*/) {
  write_line("?");
}

void TextBaseDriver::write_speeds(const BaseVelocity& velocity) {
  const std::string hold = "," + std::to_string(std::llround(1e3 * settings().watchdog_s));
  const auto milli = [](double value) { return std::to_string(std::llround(1e3 * value)); };
  if (settings().text.mixes) {
    return write_line("W," + milli(velocity.linear_mps) + "," + milli(velocity.angular_radps) +
                      hold);
  }
  const double side_mps = 0.5 * units().track_m * velocity.angular_radps;
  write_line("V," + milli(velocity.linear_mps - side_mps) + "," +
             milli(velocity.linear_mps + side_mps) + hold);
}

void TextBaseDriver::write_stop() {
  write_line("S");
}

void TextBaseDriver::count_drops(McpDrops& drops) const {
  count_of(drops, McpDrop::kChecksum) = reader_.counters().bad_checksum;
  count_of(drops, McpDrop::kLongLine) = reader_.counters().long_lines;
  count_of(drops, McpDrop::kGarbage) = reader_.counters().noise_bytes;
  count_of(drops, McpDrop::kBadReport) = bad_fields_;
}

}  // namespace topogeo::devices
