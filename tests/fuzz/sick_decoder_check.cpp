#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "topogeo/devices/pls_driver.hpp"
#include "topogeo/devices/sick_crc.hpp"
#include "topogeo/devices/sick_telegram.hpp"

#include "checks.hpp"

namespace topogeo::fuzz {
namespace {

using SickBytes = std::vector<std::uint8_t>;
using devices::SickDecoder;
using devices::SickEvent;

constexpr std::int64_t kByteGap_ns = 35'000'000;
/// A silence after so many bytes, so that the driver also gives up and repeats its request.
constexpr std::size_t kSickPart_bytes = 97;

std::vector<SickBytes> events(SickDecoder& decoder) {
  std::vector<SickBytes> found;
  while (const auto event = decoder.next()) {
    SickBytes bytes{static_cast<std::uint8_t>(event->kind)};
    if (event->kind == SickEvent::Kind::kTelegram) {
      const devices::SickTelegram& telegram = event->telegram;
      bytes = telegram.address < 0x80
                  ? devices::sick_command(telegram.code, telegram.data, telegram.address)
                  : devices::sick_reply(telegram.code, telegram.data, telegram.status,
                                        telegram.address);
    }
    found.push_back(std::move(bytes));
  }
  return found;
}

std::vector<SickBytes> decode(SickDecoder& decoder, std::span<const std::uint8_t> bytes,
                              std::size_t part) {
  std::vector<SickBytes> found;
  for (std::size_t at = 0; at < bytes.size(); at += part) {
    decoder.push(bytes.subspan(at, std::min(part, bytes.size() - at)), 0);
    std::ranges::move(events(decoder), std::back_inserter(found));
  }
  decoder.tick(kByteGap_ns);
  std::ranges::move(events(decoder), std::back_inserter(found));
  return found;
}

/// Requires that found telegrams occur in the stream, in order, each byte used once.
void check_found(std::span<const std::uint8_t> bytes, const std::vector<SickBytes>& found) {
  auto rest = bytes.begin();
  for (const SickBytes& event : found) {
    if (event.size() == 1) continue;
    const auto start = std::search(rest, bytes.end(), event.begin(), event.end());
    require(start != bytes.end(), "a telegram stands in the stream, behind the one before");
    rest = start + static_cast<std::ptrdiff_t>(event.size());
  }
}

void check_counts(const devices::SickCounters& counters, std::size_t size) {
  require(counters.telegrams * 7 + counters.acks + counters.naks + counters.noise_bytes <= size,
          "no byte is counted twice");
}

void check_listener(std::span<const std::uint8_t> bytes, SickDecoder::Listener listener) {
  SickDecoder whole(listener, kByteGap_ns);
  const std::vector<SickBytes> found = decode(whole, bytes, bytes.size() + 1);
  check_found(bytes, found);
  check_counts(whole.counters(), bytes.size());
  SickDecoder parts(listener, kByteGap_ns);
  require(decode(parts, bytes, 3) == found, "the cut of the stream does not matter");
  require(parts.counters() == whole.counters(), "nor does it for what is counted");
  // After a silence, a good telegram is found behind any bytes, and nothing remains pending.
  const SickBytes good = devices::sick_reply(0xA0, SickBytes{0}, 0);
  const SickBytes question = devices::sick_command(0x31);
  const SickBytes& last = listener == SickDecoder::Listener::kHost ? good : question;
  whole.push(last, 3 * kByteGap_ns);
  const std::vector<SickBytes> behind = events(whole);
  require(behind.size() == 1 && behind.front() == last, "what follows a silence is found");
}

void check_scan(const devices::LaserScan& scan, std::int64_t last_ns) {
  require(scan.stamp_ns > last_ns, "stamps increase strictly");
  require(scan.ranges_m.size() >= 101 && scan.ranges_m.size() <= 401, "beam counts are known ones");
  require(scan.angle_step_rad > 0.0 && std::isfinite(scan.angle_min_rad), "angles are usable");
  require(std::ranges::all_of(scan.ranges_m,
                              [](float r) { return std::isfinite(r) && r >= 0.0F && r < 50.0F; }),
          "ranges are below the largest");
}

/// Feeds the bytes to the driver as the sensor's answers, with time for timeouts and requests.
void check_pls_driver(std::span<const std::uint8_t> bytes) {
  devices::PlsDriver driver({});
  std::int64_t now_ns = 0;
  std::int64_t last_ns = -10'000'000'000;
  driver.opened(now_ns);
  for (std::size_t at = 0; at < bytes.size(); at += kSickPart_bytes) {
    driver.receive(bytes.subspan(at, std::min(kSickPart_bytes, bytes.size() - at)), now_ns);
    (void)driver.take_orders();
    for (const devices::LaserScan& scan : driver.take_scans()) {
      check_scan(scan, last_ns);
      last_ns = scan.stamp_ns;
    }
    now_ns = std::clamp(driver.due_ns(), now_ns + 1'000'000, now_ns + 5'000'000);
    driver.tick(now_ns);
    require(driver.due_ns() > now_ns, "nothing is due any more after a tick");
  }
}

}  // namespace

std::size_t check_sick_decoder(std::string_view text) {
  const SickBytes bytes(text.begin(), text.end());
  check_listener(bytes, SickDecoder::Listener::kHost);
  check_listener(bytes, SickDecoder::Listener::kSensor);
  check_pls_driver(bytes);
  SickDecoder decoder(SickDecoder::Listener::kHost, kByteGap_ns);
  (void)decode(decoder, bytes, bytes.size() + 1);
  return decoder.counters().telegrams;
}

}  // namespace topogeo::fuzz
