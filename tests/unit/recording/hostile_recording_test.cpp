// Malicious recordings that would keep their reader busy, or fill its memory.
#include <fstream>
#include <memory>

#include <gmock/gmock.h>
#include <sqlite3.h>

#include "topogeo/recording/message_source.hpp"

#include "compression.hpp"
#include "hostile_files.hpp"
#include "input_file.hpp"
#include "recorded_drive.hpp"

namespace topogeo::recording {
namespace {

using test::refusal_of;
using testing::AllOf;
using testing::HasSubstr;

class HostileRecording : public RecordingFiles {
 protected:
  /// A .db3 made by these statements.
  std::filesystem::path database(const std::string& sql) const {
    std::filesystem::remove(path("a.db3"));
    sqlite3* raw = nullptr;
    EXPECT_EQ(sqlite3_open(path("a.db3").c_str(), &raw), SQLITE_OK);
    const std::unique_ptr<sqlite3, int (*)(sqlite3*)> file(raw, &sqlite3_close);
    EXPECT_EQ(sqlite3_exec(raw, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
        << sqlite3_errmsg(raw);
    return path("a.db3");
  }
  static std::string refusal(const std::filesystem::path& file) {
    return refusal_of(
        [&] { static_cast<void>(open_messages(file, [](const Topic&) { return true; })); });
  }
};

constexpr const char* kMessages =
    "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data "
    "BLOB);";
constexpr const char* kTopics =
    "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT);";

TEST_F(HostileRecording, OfViewsOrTriggersIsRefused) {
  const std::string endless =
      "WITH RECURSIVE c(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM c) SELECT x AS id, 'a' AS "
      "name, "
      "'b' AS type, 'cdr' AS serialization_format FROM c;";
  for (const auto& [sql, named] :
       {std::pair{kMessages + std::string("CREATE VIEW topics AS ") + endless,
                  "has the view 'topics'"},
        {std::string(kTopics) + kMessages +
             "CREATE TRIGGER t AFTER INSERT ON topics BEGIN DELETE FROM topics; END;",
         "has the trigger 't'"},
        {std::string(kTopics) +
             "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, "
             "data AS (zeroblob(1000000000)));",
         "has the generated column 'data'"}}) {
    const std::filesystem::path file = database(sql);
    EXPECT_THAT(refusal(file), AllOf(HasSubstr(file.string()), HasSubstr(named)));
  }
  EXPECT_EQ(refusal(database(std::string(kTopics) + kMessages)), "");
}

TEST_F(HostileRecording, IsARegularFile) {
  for (const char* ending : {".db3", ".mcap", ".bag"}) {
    std::filesystem::create_directories(path("none"));
    for (const test::IrregularFile& file : test::irregular_files(path("none"), ending)) {
      EXPECT_THAT(refusal(file.path),
                  AllOf(HasSubstr(file.path.string()), HasSubstr("is " + file.kind)));
    }
  }
}

TEST_F(HostileRecording, FolderNamesRegularFilesAlone) {
  std::filesystem::create_directories(path("drive"));
  test::make_fifo(path("drive/fifo"));
  const auto named = [&](const std::string& file) {
    std::ofstream(path("drive/metadata.yaml"))
        << "rosbag2_bagfile_information:\n  relative_file_paths: [" << file << "]\n";
    return refusal(path("drive"));
  };
  EXPECT_THAT(named("."), AllOf(HasSubstr("metadata.yaml:2: "), HasSubstr("expected a file")))
      << "a folder in itself";
  EXPECT_THAT(named("/dev/zero"), HasSubstr("is a device"));
  EXPECT_THAT(named("fifo"), HasSubstr("is a FIFO"));
  EXPECT_THAT(named(""), HasSubstr("expected a file or more"));
  test::make_fifo(path("drive/metadata.yaml"));
  EXPECT_THAT(refusal(path("drive")), HasSubstr("metadata.yaml: is a FIFO"));
}

TEST_F(HostileRecording, UnpacksToSoMuchAlone) {
  UnpackBudget budget(1000);
  budget.take(std::uint64_t{1} << 30U);
  budget.take(100'000);
  EXPECT_THROW(budget.take(1), FormatError);
  // Blocks of zeros, which compress to a thousandth of their size.
  const std::vector<std::byte> zeros(std::size_t{1} << 20U);
  const std::vector<std::byte> block = compress(zeros, Compression::kZstd);
  UnpackBudget small(0);
  std::vector<std::byte> out;
  const auto unpack_all = [&] {
    for (int i = 0; i < 1025; ++i) {
      decompress(block, Compression::kZstd, zeros.size(), small, out);
    }
  };
  EXPECT_THAT(refusal_of(unpack_all), HasSubstr("at most 100 times its size"));
  EXPECT_THAT(
      refusal_of([&] { decompress(block, Compression::kZstd, kLargestBlock + 1, budget, out); }),
      HasSubstr("expected a block of up to 256 MiB"));
}

TEST_F(HostileRecording, DamageEndsInAnErrorOrADrive) {
  support::Random random(20261130);
  for (const char* name : {"a.mcap", "a.bag", "a.db3"}) {
    const std::string good = bytes_of(write_drive(path(name), "none"));
    for (int i = 0; i < test::damaged_files(); ++i) {
      const std::filesystem::path bad = path(std::string("bad_") + name);
      put_bytes(bad, test::with_damage(good, random));
      static_cast<void>(refusal_of([&] { static_cast<void>(read_scans(bad)); }));
    }
  }
}

}  // namespace
}  // namespace topogeo::recording
