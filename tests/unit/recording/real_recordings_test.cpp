// Recordings from elsewhere, beside the project like the recorded logs; skipped without them.
#include <cstdlib>
#include <cstring>

#include <gmock/gmock.h>

#include "topogeo/recording/convert.hpp"
#include "topogeo/recording/message_source.hpp"
#include "topogeo/ros_conversions/messages.hpp"

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

/// ROS 1 numbers its headers, our messages have zeros: clears the number at the start of scans and
/// odometry, and of each transform.
template <typename Message>
void clear_numbers(std::vector<std::byte>& message) {
  constexpr std::size_t kNumber = sizeof(std::uint32_t);
  if (!std::is_same_v<Message, ros::TFMessage>) {
    std::fill_n(message.begin(), kNumber, std::byte{0});
    return;
  }
  const auto number_at = [&](std::size_t at) {
    std::uint32_t number = 0;
    std::memcpy(&number, &message.at(at), kNumber);
    return number;
  };
  std::size_t at = kNumber;
  for (std::uint32_t left = number_at(0); left > 0; --left) {
    std::fill_n(message.begin() + static_cast<std::ptrdiff_t>(at), kNumber, std::byte{0});
    at += kNumber + 2 * kNumber;    // the number itself, the stamp
    at += kNumber + number_at(at);  // frame_id
    at += kNumber + number_at(at);  // child_frame_id
    constexpr std::size_t kTransform = 7 * sizeof(double);
    at += kTransform;
  }
}

template <typename Message>
void expect_same_bytes(const RawMessage& message, Encoding encoding) {
  std::vector<std::byte> bytes;
  encode(decode<Message>(message.data, encoding), encoding, bytes);
  std::vector<std::byte> given(message.data.begin(), message.data.end());
  if (encoding == Encoding::kRos1) clear_numbers<Message>(given);
  // Writers may pad the last four bytes.
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
      if (topic.type == kTfType) expect_same_bytes<ros::TFMessage>(message, topic.encoding);
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
