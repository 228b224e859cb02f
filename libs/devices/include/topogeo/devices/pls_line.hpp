// The serial line to a SICK laser: its settings, the telegrams that come over it, what is written
// to it, and where the sensor was heard.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "topogeo/devices/pls_settings.hpp"
#include "topogeo/devices/serial_driver.hpp"
#include "topogeo/devices/sick_exchange.hpp"
#include "topogeo/devices/sick_telegram.hpp"

namespace topogeo::devices {

class PlsLine {
 public:
  /// Keeps a reference to `settings`.
  explicit PlsLine(const PlsSettings& settings);

  /// A port was opened, whose settings are not known: at those where the sensor was heard last, or
  /// after power-on.
  void open();
  void close();

  /// Changes the settings of the port where they differ; garbage counts from here on.
  void set(const LineSettings& line);
  [[nodiscard]] const LineSettings& settings() const { return line_; }
  /// A PLS has even parity, an LMS none.
  [[nodiscard]] bool lms() const { return line_.parity == Parity::kNone; }
  /// The line of a sensor that was switched on, of the kind that was heard last.
  [[nodiscard]] LineSettings power_on() const;

  /// A telegram came: it proves the settings.
  void heard() {
    known_ = line_;
    expected_ = false;
  }
  /// It was heard there before this began: that counts until it is heard elsewhere or doubted.
  void expect(const LineSettings& line) {
    known_ = line;
    expected_ = true;
  }
  /// It is known by expect() alone.
  [[nodiscard]] bool expected() const { return expected_; }
  /// It is not where it was expected.
  void doubt() {
    known_.reset();
    expected_ = false;
  }
  /// Where the sensor was heard last.
  [[nodiscard]] const std::optional<LineSettings>& known() const { return known_; }

  void receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns);
  /// Silence counts from now on.
  void listen(std::int64_t now_ns) { last_byte_ns_ = now_ns; }
  [[nodiscard]] std::int64_t last_byte_ns() const { return last_byte_ns_; }
  [[nodiscard]] SickDecoder& decoder() { return decoder_; }
  [[nodiscard]] const SickDecoder& decoder() const { return decoder_; }
  /// Bytes and telegrams that the decoder dropped since the last `set`, as one number that grows
  /// with any garbage.
  [[nodiscard]] std::uint64_t garbage() const;

  void write(std::vector<std::uint8_t> bytes);
  /// Writes the command of the exchange if it is due.
  void write(SickExchange& exchange);
  /// Starts an exchange and writes its command.
  void ask(SickExchange& exchange, std::vector<std::uint8_t> command,
           const SickExchange::Limits& limits, std::int64_t now_ns);
  /// What was written since the last call, in order.
  [[nodiscard]] std::vector<LineOrder> take_orders();

  /// A whole scan of 361 beams on the line.
  [[nodiscard]] std::int64_t scan_time_ns() const;

 private:
  [[nodiscard]] std::uint64_t drops() const;

  const PlsSettings& settings_;
  SickDecoder decoder_;
  LineSettings line_;
  std::optional<LineSettings> known_;
  bool expected_ = false;
  std::vector<LineOrder> orders_;
  std::uint64_t drops_before_ = 0;
  std::int64_t last_byte_ns_ = 0;
};

}  // namespace topogeo::devices
