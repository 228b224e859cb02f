// Malicious map databases that would run their authors' SQL, or run without end.
#include <fstream>
#include <memory>

#include <gmock/gmock.h>
#include <sqlite3.h>

#include "topogeo/sqlite_guard/sqlite_guard.hpp"
#include "topogeo/storage/map_database.hpp"
#include "topogeo/storage/map_snapshots.hpp"
#include "topogeo/storage/read_map.hpp"
#include "topogeo/storage/salvage.hpp"

#include "hostile_files.hpp"
#include "sample_map.hpp"

namespace topogeo::storage {
namespace {

using test::refusal_of;
using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;

using Connection = std::unique_ptr<sqlite3, int (*)(sqlite3*)>;

Connection connection_to(const std::filesystem::path& path) {
  sqlite3* raw = nullptr;
  EXPECT_EQ(sqlite3_open(path.c_str(), &raw), SQLITE_OK);
  return {raw, &sqlite3_close};
}

int run(sqlite3* database, const std::string& sql) {
  return sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr);
}

class HostileDatabase : public ScratchDirectory {
 protected:
  [[nodiscard]] std::filesystem::path path() const { return directory_ / "map.sqlite"; }

  /// A valid map with additions to its schema.
  void make(const std::string& sql) const {
    for (const char* part : {"", "-wal", "-shm"}) std::filesystem::remove(path().string() + part);
    MapDatabase::open_or_create(path(), "robot-1", 1).put_document(sample_document(3));
    const Connection other = connection_to(path());
    EXPECT_EQ(run(other.get(), sql), SQLITE_OK) << sqlite3_errmsg(other.get());
    EXPECT_EQ(run(other.get(), "PRAGMA wal_checkpoint(TRUNCATE)"), SQLITE_OK);
  }
};

constexpr const char* kWithoutEnd =
    "WITH RECURSIVE c(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM c) SELECT x FROM c";

TEST_F(HostileDatabase, WithMoreThanTablesIsRefusedByAllThatOpenIt) {
  for (const auto& [sql, named] :
       {std::pair{std::string("CREATE TRIGGER wipe AFTER INSERT ON stop BEGIN DELETE FROM "
                              "stop; END"),
                  "has the trigger 'wipe'"},
        {std::string("CREATE VIEW endless AS ") + kWithoutEnd, "has the view 'endless'"},
        {"CREATE TABLE big(a INTEGER, b AS (zeroblob(1000000000)))",
         "has the generated column 'b'"},
        {"CREATE VIRTUAL TABLE box USING rtree(id, low, high)", "has the virtual table 'box'"}}) {
    make(sql);
    const auto is_named = AllOf(HasSubstr(path().string()), HasSubstr(named));
    EXPECT_THAT(refusal_of([&] { static_cast<void>(read_map(path())); }), is_named);
    EXPECT_THAT(refusal_of([&] { MapDatabase::open_existing(path()); }), is_named);
    EXPECT_THAT(refusal_of([&] { MapDatabase::open_or_create(path(), "robot-1", 1); }), is_named);
    EXPECT_THAT(refusal_of([&] { take_snapshot(path(), "one"); }), is_named);
  }
}

TEST_F(HostileDatabase, GivesItsTablesToWhoSavesThem) {
  make(std::string("CREATE VIEW endless AS ") + kWithoutEnd +
       "; CREATE TRIGGER wipe AFTER INSERT ON stop BEGIN DELETE FROM stop; END;"
       "CREATE VIRTUAL TABLE box USING rtree(id, low, high)");
  const auto tables = salvage_tables(path());
  EXPECT_FALSE(tables.contains("endless"));
  EXPECT_FALSE(tables.contains("box"));
  EXPECT_EQ(tables.at("stop").rows.size(), 3U);
}

TEST_F(HostileDatabase, IsARegularFile) {
  for (const test::IrregularFile& file : test::irregular_files(directory_, ".sqlite")) {
    const auto is_named = AllOf(HasSubstr(file.path.string()), HasSubstr("is " + file.kind));
    EXPECT_THAT(refusal_of([&] { static_cast<void>(read_map(file.path)); }), is_named);
    EXPECT_THAT(refusal_of([&] { MapDatabase::open_existing(file.path); }), is_named);
    EXPECT_THAT(refusal_of([&] { static_cast<void>(salvage_tables(file.path)); }), is_named);
  }
  make("");
  for (const char* part : {"-wal", "-journal"}) {
    const std::filesystem::path beside = test::make_fifo(path().string() + part);
    EXPECT_THAT(refusal_of([&] { static_cast<void>(read_map(path())); }),
                HasSubstr(beside.string() + ": is a FIFO"));
    std::filesystem::remove(beside);
  }
}

TEST_F(HostileDatabase, StatementsEndWithTheirLimit) {
  const Connection database = connection_to(":memory:");
  {
    const sqlite_guard::WorkLimit limit(database.get(), 0);
    EXPECT_EQ(run(database.get(), "SELECT 1"), SQLITE_OK);
    EXPECT_FALSE(limit.reached());
    EXPECT_EQ(run(database.get(), std::string("SELECT count(*) FROM (") + kWithoutEnd + ")"),
              SQLITE_INTERRUPT);
    EXPECT_TRUE(limit.reached());
  }
  EXPECT_EQ(run(database.get(), "SELECT 1"), SQLITE_OK) << "the connection has no limit any more";
}

TEST_F(HostileDatabase, DamageEndsInAnErrorOrAMap) {
  make("");
  std::ifstream in(path(), std::ios::binary);
  const std::string good(std::istreambuf_iterator<char>(in), {});
  support::Random random(20261129);
  for (int i = 0; i < test::damaged_files(); ++i) {
    const std::filesystem::path bad = directory_ / "bad.sqlite";
    std::ofstream(bad, std::ios::binary) << test::with_damage(good, random);
    const std::string refusal = refusal_of([&] { static_cast<void>(read_map(bad)); });
    EXPECT_THAT(refusal, AnyOf("", HasSubstr("bad.sqlite")));
    static_cast<void>(refusal_of([&] { static_cast<void>(salvage_tables(bad)); }));
  }
}

}  // namespace
}  // namespace topogeo::storage
