#include "topogeo/devices/pls_settings.hpp"

#include <stdexcept>
#include <string>

#include "topogeo/devices/pls_messages.hpp"

namespace topogeo::devices {
namespace {

void require(bool holds, const char* name, const std::string& value, const char* allowed) {
  if (holds) return;
  throw std::invalid_argument(std::string("laser setting ") + name + " is " + value +
                              ", expected " + allowed);
}

void require_rate(const char* name, std::uint32_t baud) {
  require(pls_baud_command(baud).has_value(), name, std::to_string(baud),
          "9600, 19200, 38400 or 500000");
}

void require_time(const char* name, std::int64_t time_ns) {
  require(time_ns >= 0 && time_ns <= 60'000'000'000, name, std::to_string(time_ns) + " ns",
          "0 to 60 s");
}

void require_password(const char* name, const std::string& password) {
  require(password.size() == 8, name, "'" + password + "'", "8 characters");
}

void check_times(const PlsSettings& s) {
  require_time("ack_timeout_ns", s.ack_timeout_ns);
  require_time("reply_timeout_ns", s.reply_timeout_ns);
  require_time("baud_reply_timeout_ns", s.baud_reply_timeout_ns);
  require_time("repeat_gap_ns", s.repeat_gap_ns);
  require_time("settle_ns", s.settle_ns);
  require_time("byte_gap_ns", s.byte_gap_ns);
  require_time("detection_quiet_ns", s.detection_quiet_ns);
  require_time("first_pause_ns", s.first_pause_ns);
  require_time("longest_pause_ns", s.longest_pause_ns);
  require_time("shortest_silence_ns", s.shortest_silence_ns);
  require_time("sweep_to_send_ns", s.sweep_to_send_ns);
  require(s.scan_period_ns >= 1'000'000 && s.scan_period_ns <= 1'000'000'000, "scan_period_ns",
          std::to_string(s.scan_period_ns) + " ns", "1 ms to 1 s");
}

}  // namespace

void PlsSettings::check() const {
  require_rate("baud", baud);
  require_rate("power_on_baud", power_on_baud);
  require(!detection_bauds.empty(), "detection_bauds", "empty", "at least one rate");
  for (const std::uint32_t rate : detection_bauds) require_rate("detection_bauds", rate);
  require(!parities.empty(), "parities", "empty", "at least one parity");
  require_password("password_pls", password_pls);
  require_password("password_lms", password_lms);
  check_times(*this);
  require(tries >= 1 && tries <= 20, "tries", std::to_string(tries), "1 to 20");
  require(baud_switch_tries >= 1 && baud_switch_tries <= 20, "baud_switch_tries",
          std::to_string(baud_switch_tries), "1 to 20");
  require(searches_until_failed >= 1, "searches_until_failed",
          std::to_string(searches_until_failed), "at least 1");
  require(silent_scan_periods >= 1, "silent_scan_periods", std::to_string(silent_scan_periods),
          "at least 1");
  require(range_max_m > 0.0 && range_max_m <= 1000.0, "range_max_m", std::to_string(range_max_m),
          "above 0 to 1000");
  require(first_no_return_code >= 1, "first_no_return_code", std::to_string(first_no_return_code),
          "at least 1");
  require(stuck_scans == 0 || stuck_scans >= 2, "stuck_scans", std::to_string(stuck_scans),
          "0 or at least 2");
}

}  // namespace topogeo::devices
