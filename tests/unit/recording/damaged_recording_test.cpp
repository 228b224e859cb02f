// Recordings that are cut off or damaged, and files that are no recordings.
#include <memory>

#include <gmock/gmock.h>
#include <sqlite3.h>
#include <zlib.h>

#include "recorded_drive.hpp"

namespace topogeo::recording {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

class DamagedRecording : public RecordingFiles,
                         public testing::WithParamInterface<std::pair<const char*, const char*>> {
 protected:
  [[nodiscard]] std::filesystem::path gzip(const std::string& name,
                                           const std::string& bytes) const {
    gzFile file = gzopen(path(name).c_str(), "wb");
    EXPECT_EQ(gzwrite(file, bytes.data(), static_cast<unsigned>(bytes.size())),
              static_cast<int>(bytes.size()));
    gzclose(file);
    return path(name);
  }
};

INSTANTIATE_TEST_SUITE_P(Formats, DamagedRecording,
                         testing::Values(std::pair{"a.mcap", "none"}, std::pair{"a.mcap", "zstd"},
                                         std::pair{"a.bag", "none"}, std::pair{"a.bag", "bz2"}));

constexpr std::uint32_t kLongDrive = 800;

/// A drive of several chunks.
std::filesystem::path long_drive(const std::filesystem::path& file, const char* compression) {
  LogWriter writer(file, kMounting, compression);
  scan::Scan scan;
  scan.angle_min_rad = -1.0;
  scan.angle_step_rad = 0.001;
  std::uint32_t noise = 1;
  for (std::uint32_t i = 0; i < kLongDrive; ++i) {
    scan.stamp_ns = 1'000'000'000'000 + i * 50'000'000LL;
    scan.ranges_m.clear();
    for (int beam = 0; beam < 1000; ++beam) {
      noise = noise * 1664525U + 1013904223U;
      scan.ranges_m.push_back(1.0F + static_cast<float>(noise >> 16U) * 1e-4F);
    }
    writer.write(scan);
  }
  writer.close();
  return file;
}

TEST_P(DamagedRecording, GivesWhatIsWholeWhenCutOff) {
  const std::string whole = bytes_of(long_drive(path(GetParam().first), GetParam().second));
  const std::vector<scan::Scan> all = read_scans(path(GetParam().first));
  ASSERT_EQ(all.size(), std::size_t{kLongDrive});
  const std::filesystem::path cut = path(std::string("cut_") + GetParam().first);
  put_bytes(cut, whole.substr(0, whole.size() * 6 / 10));
  LogReader reader(cut);
  std::size_t scans = 0;
  while (const std::optional<scan::Scan> scan = reader.next()) {
    ASSERT_EQ(scan->ranges_m, all[scans].ranges_m);
    ++scans;
  }
  EXPECT_GT(scans, std::size_t{kLongDrive} / 5);
  EXPECT_LT(scans, std::size_t{kLongDrive} * 6 / 10);
  EXPECT_EQ(reader.statistics().skipped_for(scan::SkipReason::kTruncated), 1U);
  ASSERT_FALSE(reader.statistics().messages.empty());
  EXPECT_THAT(reader.statistics().messages.back(),
              AllOf(HasSubstr(cut.string() + ": byte "), HasSubstr("expected")));
}

TEST_P(DamagedRecording, LosesOneChunkByDamageInsideIt) {
  const std::filesystem::path file = long_drive(path(GetParam().first), GetParam().second);
  const std::vector<scan::Scan> all = read_scans(file);
  std::string bytes = bytes_of(file);
  // No field and no length of a record is like this.
  std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() / 2), 64, '\xff');
  const std::size_t field = bytes.find("conn=", bytes.size() / 2);
  if (GetParam().second == std::string("none") && field != std::string::npos) bytes[field] = 'x';
  put_bytes(path(std::string("holed_") + GetParam().first), bytes);
  LogReader reader(path(std::string("holed_") + GetParam().first));
  std::size_t scans = 0;
  std::int64_t last_ns = 0;
  while (const std::optional<scan::Scan> scan = reader.next()) {
    last_ns = scan->stamp_ns;
    ++scans;
  }
  EXPECT_GT(scans, std::size_t{kLongDrive} / 2);
  EXPECT_LT(scans, std::size_t{kLongDrive});
  EXPECT_EQ(last_ns, all.back().stamp_ns);
  EXPECT_EQ(reader.statistics().skipped_for(scan::SkipReason::kTruncated), 1U);
}

TEST_P(DamagedRecording, IsNeverReadAsSomethingElse) {
  const std::string whole = bytes_of(write_drive(path(GetParam().first), GetParam().second));
  const std::vector<scan::Scan> drive = read_scans(path(GetParam().first));
  const std::filesystem::path damaged = path(std::string("damaged_") + GetParam().first);
  const std::size_t step = 1 + whole.size() / 150;
  for (std::size_t at = 0; at < whole.size(); at += step) {
    std::string bytes = whole;
    bytes[at] = static_cast<char>(~bytes[at]);
    put_bytes(damaged, bytes);
    try {
      EXPECT_LE(read_scans(damaged).size(), drive.size() + 1) << at;
    } catch (const std::runtime_error& error) {
      EXPECT_THAT(error.what(), HasSubstr(damaged.string())) << at;
    }
  }
}

// The checksum reveals a changed byte in a chunk of MCAP.
TEST_F(DamagedRecording, FailsItsChecksum) {
  std::string bytes = bytes_of(write_drive(path("a.mcap"), "none"));
  const std::size_t inside = bytes.find("base_link") + 2;
  bytes[inside] = 'x';
  put_bytes(path("b.mcap"), bytes);
  EXPECT_THAT(open_error(path("b.mcap")), HasSubstr("expected laser scans"));
}

// Nothing is whole: the error gives the position where the file becomes invalid.
TEST_P(DamagedRecording, WithoutAnythingWholeIsRefusedWithThePosition) {
  const std::string whole = bytes_of(write_drive(path(GetParam().first), GetParam().second));
  put_bytes(path("cut"), whole.substr(0, whole.size() / 8));
  EXPECT_THAT(open_error(path("cut")),
              AllOf(HasSubstr("expected laser scans"), HasSubstr("cut: byte ")));
}

// A full disk or a crash leaves such files.
TEST_F(DamagedRecording, OfZerosIsRefusedWithThePosition) {
  const std::string head = bytes_of(write_drive(path("a.mcap"), "none")).substr(0, 8);
  put_bytes(path("zeros.mcap"), head + std::string(1000, '\0'));
  EXPECT_THAT(open_error(path("zeros.mcap")), HasSubstr("byte 8: expected a record, got zeros"));
}

TEST_F(DamagedRecording, OfSqliteIsRefusedOrReadInPart) {
  const std::string whole = bytes_of(write_drive(path("a.db3")));
  for (std::size_t part = 1; part < 8; ++part) {
    put_bytes(path("b.db3"), whole.substr(0, whole.size() * part / 8));
    const std::string error = open_error(path("b.db3"));
    if (!error.empty()) {
      EXPECT_THAT(error, HasSubstr("b.db3"));
    }
  }
}

TEST_F(DamagedRecording, IsNoneByItsFirstBytes) {
  for (const char* name : {"a.mcap", "a.db3", "a.bag"}) {
    put_bytes(path(name), "FLASER 2 1 1 0 0 0 0 0 0 1.0 h 1.0\n");
    EXPECT_THAT(open_error(path(name)), AllOf(HasSubstr(name), HasSubstr("byte 0: expected")));
    EXPECT_THAT(open_error(path(std::string("no_") + name)),
                HasSubstr("expected a file, found none"));
  }
  put_bytes(path("v1.bag"), "#ROSBAG V1.2\n");
  EXPECT_THAT(open_error(path("v1.bag")), HasSubstr("version 2.0"));
  put_bytes(path("v1.bag"), "#ROSRECORD V1.2\n");
  EXPECT_THAT(open_error(path("v1.bag")),
              AllOf(HasSubstr("version 1"), HasSubstr("rosbag filter")));
  put_bytes(path("whole.db3.zstd"), "\x28\xB5\x2F\xFD\x24");
  EXPECT_THAT(open_error(path("whole.db3.zstd")), HasSubstr("zstd -d"));
  put_bytes(path("text.clf"), "FLASER 2 1 1 0 0 0 0 0 0 1.0 h 1.0\n");
  EXPECT_THAT(open_error(path("text.clf")), IsEmpty());
}

TEST_F(DamagedRecording, IsNamedForWhatItIsPackedWith) {
  using std::string_literals::operator""s;
  for (const auto& [bytes, named] :
       {std::pair{"\xFD"
                  "7zXZ\0"s,
                  "packed with xz; unpack it first with `unxz /"},
        std::pair{"BZh91AY"s, "bunzip2"}, std::pair{"PK\x03\x04"s, "unzip"},
        std::pair{"\x04\x22\x4D\x18"s, "unlz4"}, std::pair{"7z\xBC\xAF\x27\x1C"s, "7-Zip"}}) {
    put_bytes(path("a.bag.packed"), bytes + "123456789");
    EXPECT_THAT(open_error(path("a.bag.packed")), HasSubstr(named));
  }
  for (const char* name : {"a.bag", "a.mcap", "a.db3"}) {
    const std::string bytes = bytes_of(write_drive(path(name)));
    const std::filesystem::path packed = gzip(std::string(name) + ".gz", bytes);
    EXPECT_THAT(open_error(packed), HasSubstr("packed with gzip; unpack it first with `gunzip /"));
  }
  const std::filesystem::path log = write_drive(path("a.clf.gz"));
  EXPECT_THAT(open_error(log), IsEmpty());  // read as it is
  EXPECT_THAT(open_error(gzip("twice.clf.gz", bytes_of(log))),
              HasSubstr("packed with gzip twice; unpack it first with `gunzip /"));
  std::string archive(512, '\0');
  archive.replace(0, 9, "drive.bag");
  archive.replace(257, 5, "ustar");
  put_bytes(path("drive.tar"), archive);
  EXPECT_THAT(open_error(path("drive.tar")),
              AllOf(HasSubstr("packed with tar; unpack it first with `tar xf /"),
                    HasSubstr("then give the file or folder that was in it")));
  EXPECT_THAT(open_error(gzip("drive.gz", archive)), HasSubstr("`tar xzf /"));
}

// A recorder that was killed leaves the last messages in the write-ahead log.
TEST_F(DamagedRecording, IsReadWithItsWriteAheadLogOrNotAtAll) {
  const auto file = write_drive(path("a.db3"));
  const std::size_t all = read_scans(file).size();
  sqlite3* raw = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &raw), SQLITE_OK);
  const std::unique_ptr<sqlite3, int (*)(sqlite3*)> database(raw, &sqlite3_close);
  const char* move_half =
      "CREATE TEMP TABLE half AS SELECT * FROM messages WHERE id > 20;"
      "DELETE FROM messages WHERE id > 20; PRAGMA journal_mode=WAL; PRAGMA wal_autocheckpoint=0;"
      "INSERT INTO messages SELECT * FROM half;";
  ASSERT_EQ(sqlite3_exec(raw, move_half, nullptr, nullptr, nullptr), SQLITE_OK)
      << sqlite3_errmsg(raw);
  for (const char* part : {"", "-wal"}) {
    std::filesystem::copy_file(path(std::string("a.db3") + part),
                               path(std::string("b.db3") + part));
  }
  EXPECT_EQ(read_scans(path("b.db3")).size(), all);
  std::filesystem::remove(path("b.db3-shm"));
  // SQLite cannot write there.
  std::filesystem::create_symlink(path("none/none"), path("b.db3-shm"));
  EXPECT_THAT(open_error(path("b.db3")),
              AllOf(HasSubstr("b.db3: has messages in"), HasSubstr("b.db3-wal")));
}

TEST_F(DamagedRecording, IsRecognisedByItsContentUnderAnotherName) {
  const auto file = write_drive(path("a.mcap"));
  std::filesystem::copy_file(file, path("recording.log"));
  expect_same_scans(read_scans(path("recording.log")), read_scans(file));
}

}  // namespace
}  // namespace topogeo::recording
