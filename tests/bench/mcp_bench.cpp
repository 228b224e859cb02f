// How fast reports of a B21 base are found in a stream of bytes; the rate is in bytes per second.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <benchmark/benchmark.h>

#include "topogeo/devices/mcp_ascii.hpp"
#include "topogeo/devices/mcp_binary.hpp"
#include "topogeo/support/random.hpp"

namespace {

using namespace topogeo;

constexpr std::uint32_t kAsciiMask = 0x000A0A7A;
constexpr std::uint32_t kBinaryMask = kAsciiMask | 1U;
constexpr std::size_t kReports = 1024;
constexpr std::size_t kPart_bytes = 256;

devices::McpReport report(std::uint32_t mask, support::Random& random) {
  devices::McpReport report{.mask = mask};
  for (std::size_t i = 0; i < devices::kMcpFields; ++i) {
    if ((mask >> i & 1U) != 0) report.fields[i] = static_cast<std::uint32_t>(random.below(0x10000));
  }
  return report;
}

template <typename Decoder>
void decode(benchmark::State& state, const Decoder& fresh,
            const std::vector<std::uint8_t>& stream) {
  std::size_t found = 0;
  for (auto _ : state) {
    Decoder decoder = fresh;
    std::vector<devices::McpMessage> messages;
    found = 0;
    for (std::size_t at = 0; at < stream.size(); at += kPart_bytes) {
      const std::size_t size = std::min(kPart_bytes, stream.size() - at);
      decoder.decode(std::span(stream).subspan(at, size), messages);
      found += messages.size();
      benchmark::DoNotOptimize(messages.data());
      messages.clear();
    }
  }
  if (found != kReports) state.SkipWithError("reports are missing");
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(stream.size()));
}

void ascii(benchmark::State& state) {
  support::Random random(1);
  std::vector<std::uint8_t> stream;
  for (std::size_t i = 0; i < kReports; ++i) {
    devices::append_ascii(report(kAsciiMask, random), {}, stream);
  }
  decode(state, devices::McpAsciiDecoder(kAsciiMask), stream);
}

void binary(benchmark::State& state) {
  support::Random random(1);
  std::vector<std::uint8_t> stream;
  for (std::size_t i = 0; i < kReports; ++i) {
    devices::append_binary_frame(
        devices::binary_payload(report(kBinaryMask, random), devices::McpCommand::kReportMask),
        stream);
  }
  decode(state, devices::McpBinaryDecoder(), stream);
}

BENCHMARK(ascii)->Name("mcp/decode/ascii");
BENCHMARK(binary)->Name("mcp/decode/binary");

}  // namespace
