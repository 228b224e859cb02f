// How fast telegrams of a SICK laser are found in a stream of bytes; the rate is in bytes per
// second.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <benchmark/benchmark.h>

#include "topogeo/devices/sick_crc.hpp"
#include "topogeo/devices/sick_telegram.hpp"
#include "topogeo/support/random.hpp"

namespace {

using namespace topogeo;

constexpr std::int64_t kByteGap_ns = 35'000'000;
constexpr std::size_t kScans = 256;

std::vector<std::uint8_t> scan(support::Random& random, std::uint64_t most_cm) {
  std::vector<std::uint8_t> data{0x69, 0x01};
  for (int i = 0; i < 361; ++i) {
    const std::uint64_t code = most_cm == 0 ? 0x8002 : random.below(most_cm);
    data.push_back(static_cast<std::uint8_t>(code & 0xFFU));
    data.push_back(static_cast<std::uint8_t>(code >> 8));
  }
  return devices::sick_reply(0xB0, data, 0);
}

// Whole scans of 361 values, in parts as a port delivers them; the stream begins in mid-scan when
// `late` bytes of it are missing.
void decode_scans(benchmark::State& state, std::size_t part, std::uint64_t most_cm,
                  std::size_t late) {
  support::Random random(1);
  std::vector<std::uint8_t> stream;
  for (std::size_t i = 0; i < kScans; ++i) {
    const std::vector<std::uint8_t> telegram = scan(random, most_cm);
    stream.insert(stream.end(), telegram.begin(), telegram.end());
  }
  stream.erase(stream.begin(), stream.begin() + static_cast<std::ptrdiff_t>(late));
  std::uint64_t telegrams = 0;
  for (auto _ : state) {
    devices::SickDecoder decoder(devices::SickDecoder::Listener::kHost, kByteGap_ns);
    for (std::size_t at = 0; at < stream.size(); at += part) {
      decoder.push(std::span(stream).subspan(at, std::min(part, stream.size() - at)), 0);
      while (const auto event = decoder.next()) benchmark::DoNotOptimize(event->telegram.status);
    }
    telegrams = decoder.counters().telegrams;
  }
  if (telegrams != kScans - (late > 0 ? 1 : 0)) state.SkipWithError("telegrams are missing");
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(stream.size()));
}

void check_word(benchmark::State& state) {
  support::Random random(1);
  const std::vector<std::uint8_t> telegram = scan(random, 5000);
  for (auto _ : state) benchmark::DoNotOptimize(devices::sick_crc(telegram));
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(telegram.size()));
}

}  // namespace

BENCHMARK_CAPTURE(decode_scans, pls, 4096, 5000, 0)->Name("pls/decode");
BENCHMARK_CAPTURE(decode_scans, pls_parts_of_16, 16, 5000, 0)->Name("pls/decode_parts_of_16");
BENCHMARK_CAPTURE(decode_scans, pls_false_starts, 4096, 0, 10)->Name("pls/decode_false_starts");
BENCHMARK(check_word)->Name("pls/check_word");
