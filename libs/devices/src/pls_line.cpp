#include "topogeo/devices/pls_line.hpp"

#include <cstddef>
#include <utility>

#include "topogeo/devices/line_time.hpp"

namespace topogeo::devices {
namespace {

/// The longest telegram, a whole scan: two bytes for each of 361 beams, two for their number, the
/// code, the status and the frame.
constexpr std::size_t kScan_bytes = 2 * 361 + 2 + 2 + kSickFrame_bytes;

}  // namespace

PlsLine::PlsLine(const PlsSettings& settings)
    : settings_(settings), decoder_(SickDecoder::Listener::kHost, settings.byte_gap_ns) {}

void PlsLine::open() {
  line_ = known_.value_or(power_on());
  decoder_.clear();
  orders_.push_back({line_, {}});
}

void PlsLine::close() {
  decoder_.clear();
  orders_.clear();
}

void PlsLine::set(const LineSettings& line) {
  drops_before_ = drops();
  if (line == line_) return;
  line_ = line;
  decoder_.clear();
  orders_.push_back({line_, {}});
}

LineSettings PlsLine::power_on() const {
  return {settings_.power_on_baud, known_ ? known_->parity : settings_.parities.front()};
}

void PlsLine::receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  last_byte_ns_ = now_ns;
  decoder_.push(bytes, now_ns);
}

std::uint64_t PlsLine::drops() const {
  const SickCounters& counters = decoder_.counters();
  return counters.bad_crc + counters.implausible_length + counters.truncated + counters.noise_bytes;
}

std::uint64_t PlsLine::garbage() const {
  return drops() - drops_before_;
}

void PlsLine::write(std::vector<std::uint8_t> bytes) {
  orders_.push_back({std::nullopt, std::move(bytes)});
}

void PlsLine::write(SickExchange& exchange) {
  if (auto command = exchange.take_command()) write(std::move(*command));
}

void PlsLine::ask(SickExchange& exchange, std::vector<std::uint8_t> command,
                  const SickExchange::Limits& limits, std::int64_t now_ns) {
  exchange.start(std::move(command), limits, line_, now_ns);
  write(exchange);
}

std::vector<LineOrder> PlsLine::take_orders() {
  return std::exchange(orders_, {});
}

std::int64_t PlsLine::scan_time_ns() const {
  return line_time_ns(kScan_bytes, line_);
}

}  // namespace topogeo::devices
