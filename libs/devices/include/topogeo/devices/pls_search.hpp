// Searches for the rate and parity of a SICK laser. Each candidate gets a question that the sensor
// answers in any state; between two searches the line rests at the rate of a sensor after power-on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "topogeo/devices/pls_line.hpp"
#include "topogeo/devices/pls_settings.hpp"

namespace topogeo::devices {

class PlsSearch {
 public:
  /// Keeps references to both.
  PlsSearch(const PlsSettings& settings, PlsLine& line) : settings_(settings), line_(line) {}

  /// Tries the first candidate. `listen_first`: first listens where the sensor was heard last,
  /// without a question, which would stop its scans; an expected line is always only listened to
  /// first.
  void start(bool listen_first, std::int64_t now_ns);
  /// Tries the next candidate if the present one has been silent for long enough. False after the
  /// last: the search has failed.
  bool tick(std::int64_t now_ns);
  /// Time at which the present candidate is given up.
  [[nodiscard]] std::int64_t due_ns() const;
  /// Garbage at one rate shows a sensor that sends at another, perhaps one that has come back.
  /// Listens where it was heard last.
  void follow_garbage(std::int64_t now_ns);
  /// Enough garbage to show a sender rather than a disturbance of the line.
  [[nodiscard]] bool hears_garbage() const;
  /// The present candidate was asked, which stops the sensor's scans.
  [[nodiscard]] bool asked() const { return !listen_only_; }

  /// The sensor was found, or the port was opened.
  void reset() { failures_ = 0; }
  /// Failed searches since then.
  [[nodiscard]] int failures() const { return failures_; }

  /// Rests after that many failures, longer after more of them, and listens meanwhile at the rate
  /// at which a sensor announces its power-on.
  void rest(int failures, std::int64_t now_ns);
  [[nodiscard]] std::int64_t rested_ns() const { return rested_ns_; }

 private:
  [[nodiscard]] std::vector<LineSettings> planned() const;
  void try_line(const LineSettings& line, bool listen_only, std::int64_t now_ns);

  const PlsSettings& settings_;
  PlsLine& line_;
  std::vector<LineSettings> candidates_;
  std::size_t candidate_ = 0;
  bool listen_only_ = false;
  std::int64_t since_ns_ = 0;  // start of the present candidate
  std::int64_t rested_ns_ = 0;
  int failures_ = 0;
};

/// "9600 baud, even parity"
[[nodiscard]] std::string line_name(const LineSettings& line);

}  // namespace topogeo::devices
