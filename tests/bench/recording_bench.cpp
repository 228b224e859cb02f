// How fast ROS recordings are read: message by message, and as the scans for mapping; the rate is
// in bytes of messages per second.
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <unistd.h>

#include "topogeo/recording/log_reader.hpp"
#include "topogeo/recording/log_writer.hpp"
#include "topogeo/recording/message_source.hpp"
#include "topogeo/support/random.hpp"

namespace {

using namespace topogeo;

/// 3,000 scans of 1,080 beams with odometry, 15 MB, removed at the end. `maps` adds four maps of
/// 1.2 MB after every 60 scans, 240 MB in all; three of the four are in chunks of their own.
class RecordedFile {
 public:
  RecordedFile(const std::string& ending, const std::string& compression, bool maps = false)
      : path_(std::filesystem::temp_directory_path() /
              ("topogeo_bench_" + std::to_string(getpid()) + ending)) {
    support::Random random(1);
    recording::LogWriter writer(path_, {}, compression);
    scan::Scan scan;
    scan.angle_min_rad = -2.356;
    scan.angle_step_rad = 0.00436;
    scan.ranges_m.resize(1080);
    for (int i = 0; i < 3000; ++i) {
      scan.stamp_ns = 1'600'000'000'000'000'000 + i * 25'000'000LL;
      for (float& range_m : scan.ranges_m) {
        range_m = 1.0F + 0.001F * static_cast<float>(random.below(10'000));
      }
      writer.write(scan);
      constexpr int kScansPerMap = 60;
      if (!maps || i % kScansPerMap != 0) continue;
      constexpr std::uint32_t kSide = 1100;
      const std::vector<std::int8_t> cells(std::size_t{kSide} * kSide, -1);
      for (int map = 0; map < 4; ++map) {
        writer.write_grid(scan.stamp_ns, {kSide, kSide, 0.05, {}}, cells);
      }
    }
    writer.close();
  }
  ~RecordedFile() { std::filesystem::remove(path_); }
  RecordedFile(const RecordedFile&) = delete;
  RecordedFile& operator=(const RecordedFile&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

std::int64_t read_messages(const std::filesystem::path& path) {
  const auto source = recording::open_messages(path, [](const recording::Topic&) { return true; });
  recording::RawMessage message;
  std::int64_t bytes = 0;
  while (source->next(message)) bytes += static_cast<std::int64_t>(message.data.size());
  return bytes;
}

void messages(benchmark::State& state, const std::string& ending, const std::string& compression) {
  const RecordedFile file(ending, compression);
  std::int64_t bytes = 0;
  for (auto _ : state) bytes += read_messages(file.path());
  state.SetBytesProcessed(bytes);
}

void read_scans(benchmark::State& state, const std::filesystem::path& path) {
  for (auto _ : state) {
    recording::LogReader reader(path);
    std::uint64_t count = 0;
    while (const auto scan = reader.next()) ++count;
    if (count != 3000) state.SkipWithError("scans are missing");
  }
}

void scans(benchmark::State& state, const std::string& ending) {
  const RecordedFile file(ending, "none");
  const std::int64_t bytes = read_messages(file.path());
  read_scans(state, file.path());
  state.SetBytesProcessed(state.iterations() * bytes);
}

/// Unless `indexed`, the index lacks its checksum and is not used. Rate in bytes of the file.
void scans_among_maps(benchmark::State& state, bool indexed) {
  const RecordedFile file(".mcap", "none", true);
  if (!indexed) {
    std::fstream bytes(file.path(), std::ios::binary | std::ios::in | std::ios::out);
    constexpr int kChecksumToEnd = 12;
    bytes.seekp(-kChecksumToEnd, std::ios::end);
    bytes.write("\0\0\0\0", 4);
  }
  read_scans(state, file.path());
  state.SetBytesProcessed(state.iterations() *
                          static_cast<std::int64_t>(std::filesystem::file_size(file.path())));
}

BENCHMARK_CAPTURE(messages, mcap, ".mcap", "none")->Name("recording/messages/mcap");
BENCHMARK_CAPTURE(messages, mcap_zstd, ".mcap", "zstd")->Name("recording/messages/mcap_zstd");
BENCHMARK_CAPTURE(messages, mcap_lz4, ".mcap", "lz4")->Name("recording/messages/mcap_lz4");
BENCHMARK_CAPTURE(messages, db3, ".db3", "none")->Name("recording/messages/db3");
BENCHMARK_CAPTURE(messages, bag, ".bag", "none")->Name("recording/messages/bag");
BENCHMARK_CAPTURE(scans, mcap, ".mcap")->Name("recording/scans/mcap");
BENCHMARK_CAPTURE(scans, db3, ".db3")->Name("recording/scans/db3");
BENCHMARK_CAPTURE(scans_among_maps, mcap, true)->Name("recording/scans/mcap_maps_indexed");
BENCHMARK_CAPTURE(scans_among_maps, mcap, false)->Name("recording/scans/mcap_maps_linear");

}  // namespace
