// What others make of our files, and we of theirs: rosbag (Debian's python3-rosbag), @mcap/core and
// @foxglove/rosmsg2-serialization (npm). Each is skipped with a message where the program or the
// network is missing.
#include <cstdlib>

#include <gmock/gmock.h>

#include "recorded_drive.hpp"

namespace topogeo::recording {
namespace {

class OtherReaders : public RecordingFiles {
 protected:
  /// Runs a script beside this file with the arguments; its exit code, 77 where something that it
  /// needs is missing.
  int run(const std::string& program, const std::string& script, const std::string& arguments) {
    const std::string command = "timeout 100 " + program +
                                " " TOPOGEO_SOURCE_DIR "/tests/unit/recording/" + script + " " +
                                arguments + " > " + path("output").string() + " 2>&1";
    const int status =
        std::system(command.c_str());  // NOLINT(bugprone-command-processor,cert-env33-c)
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  [[nodiscard]] std::string output() const { return bytes_of(path("output")); }
};

constexpr int kMissing = 77;

TEST_F(OtherReaders, RosbagReadsOurBagsAndWritesSomeForUs) {
  for (const char* compression : {"none", "bz2", "lz4"}) {
    SCOPED_TRACE(compression);
    const auto file = write_drive(path(std::string(compression) + ".bag"), compression);
    const auto theirs = path(std::string(compression) + "_theirs.bag");
    const int result = run("/usr/bin/python3", "rosbag_check.py",
                           file.string() + " " + theirs.string() + " " + compression);
    if (result == kMissing) GTEST_SKIP() << output();
    ASSERT_EQ(result, 0) << output();
    expect_same_scans(read_scans(theirs), read_scans(file));
  }
}

TEST_F(OtherReaders, McapCoreReadsOursAndWritesSomeForUs) {
  const std::string packages = TOPOGEO_BIN "/../npm_recording";
  const int fetched = run("bash", "fetch_packages.sh", packages);
  if (fetched == kMissing) GTEST_SKIP() << output();
  ASSERT_EQ(fetched, 0) << output();
  for (const char* compression : {"none", "zstd"}) {
    SCOPED_TRACE(compression);
    const auto file = write_drive(path(std::string(compression) + ".mcap"), compression);
    const auto theirs = path(std::string(compression) + "_theirs.mcap");
    const int result =
        run("node", "mcap_check.mjs", packages + " " + file.string() + " " + theirs.string());
    if (result == kMissing) GTEST_SKIP() << output();
    ASSERT_EQ(result, 0) << output();
    expect_same_scans(read_scans(theirs), read_scans(file));
  }
}

}  // namespace
}  // namespace topogeo::recording
