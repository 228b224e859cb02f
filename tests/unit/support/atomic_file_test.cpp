#include "topogeo/support/atomic_file.hpp"

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>

#include "topogeo/support/secret_file.hpp"

namespace topogeo::support {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class AtomicFile : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::path(::testing::TempDir()) / "atomic_file_XXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    directory_ = name;
  }
  void TearDown() override { fs::remove_all(directory_); }

  static std::string content(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  [[nodiscard]] std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(directory_), fs::directory_iterator()));
  }

  fs::path directory_;
};

TEST_F(AtomicFile, WritesAndReplaces) {
  const fs::path path = directory_ / "map.pb";
  const std::string binary("\0\xff line\r\n", 9);
  write_file_atomically(path, "old");
  write_file_atomically(path, binary);
  EXPECT_EQ(content(path), binary);
  write_file_atomically(path, "");
  EXPECT_EQ(content(path), "");
  EXPECT_EQ(files(), 1U);
}

TEST_F(AtomicFile, SecretsAreTheirOwnersAlone) {
  const fs::path path = directory_ / "link";
  write_file_atomically(path, "for all");
  write_secret_file(path, "token");
  EXPECT_EQ(content(path), "token");
  EXPECT_EQ(fs::status(path).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_EQ(files(), 1U);
}

TEST_F(AtomicFile, NamesThePathAndLeavesNothingBehindOnFailure) {
  const fs::path path = directory_ / "taken";
  fs::create_directories(path / "inside");  // a directory cannot be replaced by a file
  try {
    write_file_atomically(path, "x");
    FAIL() << "wrote over a directory";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr(path.string() + ": cannot be replaced"));
  }
  EXPECT_EQ(files(), 1U);
  EXPECT_THROW(write_file_atomically(directory_ / "missing" / "a", "x"), std::runtime_error);
  EXPECT_THROW(write_file_atomically(directory_ / "", "x"), std::runtime_error);
}

TEST_F(AtomicFile, ChecksThatADirectoryCanBeWritten) {
  check_writable_directory(directory_ / "a" / "b");
  EXPECT_TRUE(fs::is_directory(directory_ / "a" / "b"));
  EXPECT_TRUE(fs::is_empty(directory_ / "a" / "b"));

  write_file_atomically(directory_ / "file", "x");
  EXPECT_THROW(check_writable_directory(directory_ / "file"), std::runtime_error);
  EXPECT_THROW(check_writable_directory(directory_ / "file" / "below"), std::runtime_error);
  try {
    check_writable_directory("/proc/topogeo");
    FAIL() << "wrote into /proc";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("/proc/topogeo: cannot be created"));
  }
}

}  // namespace
}  // namespace topogeo::support
