// The default files of a service: a place that another program has taken keeps no service from
// starting.
#include "topogeo/service/runtime_file.hpp"

#include <cstdlib>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "topogeo/service/operator_stop.hpp"

namespace topogeo::service {
namespace {

namespace fs = std::filesystem;

class OwnRuntimeFile : public testing::Test {
 protected:
  OwnRuntimeFile() {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    setup_.name = "navigator";
    // NOLINTNEXTLINE(concurrency-mt-unsafe): no other thread runs
    ::setenv("RUNTIME_DIRECTORY", folder_.c_str(), 1);
  }
  ~OwnRuntimeFile() override {
    ::unsetenv("RUNTIME_DIRECTORY");  // NOLINT(concurrency-mt-unsafe): the same
    fs::remove_all(folder_);
  }
  [[nodiscard]] fs::path own() const { return own_runtime_file(setup_, ".stop", "it is lost"); }
  /// The place that own() would use.
  [[nodiscard]] fs::path place() const {
    return runtime_file(setup_, "." + std::to_string(::geteuid()) + ".stop");
  }

  const fs::path folder_ =
      fs::path(testing::TempDir()) / ("topogeo_runtime_file_test." + std::to_string(::getpid()));
  service::Setup setup_;
};

TEST_F(OwnRuntimeFile, IsCreatedForItsOwnerAlone) {
  EXPECT_EQ(own(), place());
  EXPECT_EQ(fs::status(place()).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_EQ(own(), place()) << "the same file at the next start";
}

TEST_F(OwnRuntimeFile, IsNoneInAPlaceThatIsTaken) {
  fs::create_directory(place());
  EXPECT_EQ(own(), fs::path());
  EXPECT_NO_THROW(OperatorStop(OperatorStop::place_of(setup_)));
  fs::remove(place());
  fs::create_symlink(folder_ / "elsewhere", place());
  EXPECT_EQ(own(), fs::path());
  fs::remove(place());
  ASSERT_EQ(::mkfifo(place().c_str(), 0600), 0);
  EXPECT_EQ(own(), fs::path());
}

TEST_F(OwnRuntimeFile, IsNoneInAFolderThatIsNotThere) {
  fs::remove_all(folder_);
  EXPECT_EQ(own(), fs::path());
}

TEST_F(OwnRuntimeFile, IsNoneOfAnotherUser) {
  ASSERT_EQ(own(), place());
  constexpr ::uid_t kOther = 12'345;
  if (::chown(place().c_str(), kOther, static_cast<::gid_t>(-1)) != 0) {
    GTEST_SKIP() << "only root can give a file away";
  }
  EXPECT_EQ(own(), fs::path());
}

}  // namespace
}  // namespace topogeo::service
