// Supervises a SICK laser that sends scans: requests them in on-request mode, and notices when they
// are missing.
#pragma once

#include <cstdint>

#include "topogeo/devices/pls_line.hpp"
#include "topogeo/devices/pls_settings.hpp"
#include "topogeo/devices/sick_exchange.hpp"

namespace topogeo::devices {

class PlsSupervisor {
 public:
  /// Keeps references to all arguments.
  PlsSupervisor(const PlsSettings& settings, PlsLine& line, SickExchange& exchange)
      : settings_(settings), line_(line), exchange_(exchange) {}

  /// The sensor was set up; the first scan is due.
  void start(std::int64_t now_ns);
  void scan_came(std::int64_t now_ns) { last_scan_ns_ = now_ns; }
  /// The request for a scan has ended, with or without a scan.
  void request_ended(std::int64_t now_ns);

  /// Scans have been missing for too long.
  [[nodiscard]] bool silent(std::int64_t now_ns) const { return now_ns >= silent_at_ns(); }
  /// Time since the last scan.
  [[nodiscard]] std::int64_t silence_ns(std::int64_t now_ns) const {
    return now_ns - last_scan_ns_;
  }
  /// Requests the next scan if it is due.
  void tick(std::int64_t now_ns);
  [[nodiscard]] std::int64_t due_ns() const;

 private:
  [[nodiscard]] std::int64_t patience_ns() const;
  [[nodiscard]] std::int64_t silent_at_ns() const;
  [[nodiscard]] bool may_ask() const;

  const PlsSettings& settings_;
  PlsLine& line_;
  SickExchange& exchange_;
  std::int64_t last_scan_ns_ = 0;
  std::int64_t next_request_ns_ = 0;
};

}  // namespace topogeo::devices
