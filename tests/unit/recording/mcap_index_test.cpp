// The index of an MCAP file: unwanted data is skipped unread, and without an index, or with a
// damaged one, the scans are the same.
#include <functional>

#include <gmock/gmock.h>

#include "recorded_drive.hpp"

namespace topogeo::recording {
namespace {

constexpr int kScans = 60;
constexpr std::int64_t kPeriod_ns = 100'000'000;
constexpr std::int8_t kSecondMap = 77;

/// A drive with two maps after every tenth scan, each larger than a chunk: the second one, whose
/// cells are all equal, is alone in its chunk.
std::string drive_with_maps(const std::filesystem::path& file) {
  constexpr std::size_t kSide = 1100;
  LogWriter writer(file, kMounting, "none");
  const std::size_t there = short_drive().size();
  for (int i = 0; i < kScans; ++i) {  // there and back again
    const std::size_t step = static_cast<std::size_t>(i) % (2 * there);
    scan::Scan scan = short_drive()[step < there ? step : 2 * there - 1 - step];
    scan.stamp_ns = 1'600'000'000'000'000'000 + i * kPeriod_ns;
    writer.write(scan);
    if (i % 10 != 9) continue;
    const ros::GridPlace place{kSide, kSide, 0.05, {}};
    for (const std::int8_t cell : {std::int8_t{0}, kSecondMap}) {
      writer.write_grid(scan.stamp_ns, place, std::vector<std::int8_t>(kSide * kSide, cell));
    }
  }
  writer.close();
  return bytes_of(file);
}

class McapIndex : public RecordingFiles {
 protected:
  McapIndex() : whole_(drive_with_maps(path("whole.mcap"))) {}

  /// The file after a change to its bytes.
  std::filesystem::path changed(const std::function<void(std::string&)>& change) {
    std::string bytes = whole_;
    change(bytes);
    put_bytes(path("changed.mcap"), bytes);
    return path("changed.mcap");
  }
  /// Clears the checksum of the summary, which is in front of the last 8 bytes; 0 means none.
  static void forget_checksum(std::string& bytes) { bytes.replace(bytes.size() - 12, 4, 4, '\0'); }
  /// Changes a byte of each second map.
  static void damage_maps(std::string& bytes) {
    const std::string cells(1000, static_cast<char>(kSecondMap));
    const std::size_t map = bytes.find(cells);
    ASSERT_NE(map, std::string::npos);
    bytes[map + 10] = 0;
  }

  std::string whole_;
};

TEST_F(McapIndex, LeadsPastChunksOfOtherTopics) {
  const std::vector<scan::Scan> all = read_scans(path("whole.mcap"));
  ASSERT_EQ(all.size(), std::size_t{kScans});
  // Unread data is not checked.
  expect_same_scans(read_scans(changed(damage_maps)), all);
  // Without an index, only the damaged chunks are lost, which hold no scans.
  expect_same_scans(read_scans(changed([](std::string& bytes) {
                      damage_maps(bytes);
                      forget_checksum(bytes);
                    })),
                    all);
}

TEST_F(McapIndex, IsNotNeeded) {
  const std::vector<scan::Scan> all = read_scans(path("whole.mcap"));
  expect_same_scans(read_scans(changed(forget_checksum)), all);
  // The footer: opcode, length, start of the summary, start of its offsets, checksum, the magic.
  constexpr std::size_t kSummaryStart = 8 + 4 + 8 + 8;
  expect_same_scans(read_scans(changed([](std::string& bytes) {
                      bytes.replace(bytes.size() - kSummaryStart, 20, 20, '\0');
                    })),
                    all);
  constexpr std::size_t kFooter = kSummaryStart + 9;
  expect_same_scans(
      read_scans(changed([](std::string& bytes) { bytes.resize(bytes.size() - kFooter - 100); })),
      all);
}

// Any changed byte of the summary is found by its checksum.
TEST_F(McapIndex, ThatIsDamagedIsNotUsed) {
  const std::vector<scan::Scan> all = read_scans(path("whole.mcap"));
  constexpr std::size_t kWithin = 900;  // the indexes of the last chunks, offsets, footer
  for (std::size_t back = 9; back < kWithin; back += 53) {
    SCOPED_TRACE(back);
    expect_same_scans(read_scans(changed([&](std::string& bytes) {
                        char& byte = bytes[bytes.size() - back];
                        byte = static_cast<char>(~byte);
                      })),
                      all);
  }
}

}  // namespace
}  // namespace topogeo::recording
