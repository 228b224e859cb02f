// The serial line to a SICK laser: its settings, received telegrams, written commands, and the
// settings at which the sensor was last heard.
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

  /// A port with unknown settings was opened: starts with those where the sensor was heard last, or
  /// those after power-on.
  void open();
  void close();

  /// Changes the settings of the port if they differ; counts garbage from here on.
  void set(const LineSettings& line);
  [[nodiscard]] const LineSettings& settings() const { return line_; }
  /// A PLS has even parity, an LMS none.
  [[nodiscard]] bool lms() const { return line_.parity == Parity::kNone; }
  /// The line settings of a sensor after power-on, for the kind that was heard last.
  [[nodiscard]] LineSettings power_on() const;

  /// A telegram arrived: it proves the settings.
  void heard() {
    known_ = line_;
    expected_ = false;
  }
  /// The sensor was heard there earlier: used until it is heard elsewhere or doubted.
  void expect(const LineSettings& line) {
    known_ = line;
    expected_ = true;
  }
  /// The settings are known from expect() only.
  [[nodiscard]] bool expected() const { return expected_; }
  /// The sensor is not where it was expected.
  void doubt() {
    known_.reset();
    expected_ = false;
  }
  /// The settings where the sensor was heard last.
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
  /// The orders written since the last call, in order.
  [[nodiscard]] std::vector<LineOrder> take_orders();

  /// Transmission time of a whole scan of 361 beams.
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
