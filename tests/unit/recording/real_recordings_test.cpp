// Recordings of others, beside the project like the recorded logs; skipped where they are not
// there.
#include <cstdlib>

#include <gmock/gmock.h>

#include "topogeo/recording/convert.hpp"
#include "topogeo/recording/message_source.hpp"
#include "topogeo/recording/ros_types.hpp"

#include "recorded_drive.hpp"

namespace topogeo::recording {
namespace {

std::vector<std::filesystem::path> real_recordings() {
  const char* named = std::getenv("TOPOGEO_LOG_DIR");
  const std::filesystem::path folder =
      std::filesystem::path(named != nullptr ? named : TOPOGEO_SOURCE_DIR "/../shared/data") /
      "bags";
  std::vector<std::filesystem::path> found;
  if (!std::filesystem::is_directory(folder)) return found;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (is_recording(entry.path())) found.push_back(entry.path());
  }
  return found;
}

class RealRecordings : public RecordingFiles {
 protected:
  void SetUp() override {
    if (real_recordings().empty()) GTEST_SKIP() << "no recordings beside the project";
  }
};

template <typename Message>
void expect_same_bytes(const RawMessage& message, Encoding encoding) {
  std::vector<std::byte> bytes;
  encode(decode<Message>(message.data, encoding), encoding, bytes);
  std::vector<std::byte> given(message.data.begin(), message.data.end());
  // Headers of ROS 1 are numbered, ours are not; their numbers stand first in scans and odometry.
  if (encoding == Encoding::kRos1 && !std::is_same_v<Message, ros::TfMessage>) {
    std::fill_n(given.begin(), 4, std::byte{0});
  }
  // Writers may fill the last four bytes up.
  if (encoding == Encoding::kCdr && given.size() > bytes.size()) {
    ASSERT_LT(given.size() - bytes.size(), 4U);
    given.resize(bytes.size());
  }
  ASSERT_EQ(bytes, given);
}

TEST_F(RealRecordings, AreWrittenAgainAsTheSameBytes) {
  for (const std::filesystem::path& file : real_recordings()) {
    SCOPED_TRACE(file);
    const auto source = open_messages(file, [](const Topic&) { return true; });
    RawMessage message;
    std::size_t compared = 0;
    while (source->next(message)) {
      const Topic topic = source->topics()[message.topic];
      if (topic.type == kLaserScanType) expect_same_bytes<ros::LaserScan>(message, topic.encoding);
      if (topic.type == kOdometryType) expect_same_bytes<ros::Odometry>(message, topic.encoding);
      // A number per transform: sizes are compared, not these.
      if (topic.type == kTfType && topic.encoding == Encoding::kCdr) {
        expect_same_bytes<ros::TfMessage>(message, topic.encoding);
      }
      ++compared;
    }
    EXPECT_GT(compared, 500U);
    EXPECT_EQ(source->damage(), "");
  }
}

TEST_F(RealRecordings, GiveTheSameScansInEachFormat) {
  for (const std::filesystem::path& file : real_recordings()) {
    SCOPED_TRACE(file);
    const std::vector<scan::Scan> scans = read_scans(file);
    EXPECT_GT(scans.size(), 200U);
    for (const char* name : {"a.mcap", "a.db3", "a.bag", "a.clf.gz"}) {
      SCOPED_TRACE(name);
      (void)convert(file, path(name));
      expect_same_scans(read_scans(path(name)), scans);
      EXPECT_EQ(mounting_in_log(path(name)).T_robot_laser, mounting_in_log(file).T_robot_laser);
    }
  }
}

}  // namespace
}  // namespace topogeo::recording
