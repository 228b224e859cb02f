// A short drive as scans, and files with it, which are removed at the end of a test.
#pragma once

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "topogeo/recording/log_reader.hpp"
#include "topogeo/recording/log_writer.hpp"

namespace topogeo::recording {

class RecordingFiles : public ::testing::Test {
 protected:
  RecordingFiles() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() /
              ("topogeo_recording_" + std::string(test->name()) + "_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
  }
  ~RecordingFiles() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::filesystem::path path(const std::string& name) const { return folder_ / name; }

 private:
  std::filesystem::path folder_;
};

/// A robot on an arc of 2 m radius, 20 scans of 7 beams a tenth of a second apart; the last beam
/// has no return.
inline std::vector<scan::Scan> short_drive() {
  std::vector<scan::Scan> scans;
  for (int i = 0; i < 20; ++i) {
    scan::Scan scan;
    scan.sequence = static_cast<std::uint64_t>(i);
    scan.stamp_ns = 1'600'000'000'123'456'789 + i * 100'000'000LL;
    scan.angle_min_rad = -0.75;  // exact in single precision
    scan.angle_step_rad = 0.25;
    const double turn = 0.1 * i;
    scan.T_odom_robot = {2.0 * std::sin(turn), 2.0 - 2.0 * std::cos(turn), turn};
    for (int beam = 0; beam < 7; ++beam) {
      scan.ranges_m.push_back(beam == 6 ? scan::Scan::kNoReturn
                                        : 1.0F + 0.1F * static_cast<float>(beam + i));
    }
    scans.push_back(std::move(scan));
  }
  return scans;
}

inline const geometry::Pose2 kMounting{0.2, -0.05, 0.1};

inline std::filesystem::path write_drive(const std::filesystem::path& path,
                                         const std::string& compression = "zstd") {
  LogWriter writer(path, kMounting, compression);
  for (const scan::Scan& scan : short_drive()) writer.write(scan);
  writer.close();
  return path;
}

inline std::vector<scan::Scan> read_scans(const std::filesystem::path& path,
                                          const TopicChoice& topics = {}) {
  LogReader reader(path, {}, topics);
  std::vector<scan::Scan> scans;
  while (std::optional<scan::Scan> scan = reader.next()) scans.push_back(*std::move(scan));
  return scans;
}

inline std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline void put_bytes(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

/// Error message of opening a log; empty when it opens.
inline std::string open_error(const std::filesystem::path& path, const TopicChoice& topics = {}) {
  try {
    const LogReader reader(path, {}, topics);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return {};
}

/// Compares everything except the sequence numbers, which depend on the source.
inline void expect_same_scans(const std::vector<scan::Scan>& a, const std::vector<scan::Scan>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].sequence, b[i].sequence);
    EXPECT_EQ(a[i].stamp_ns, b[i].stamp_ns);
    EXPECT_EQ(a[i].angle_min_rad, b[i].angle_min_rad);
    EXPECT_EQ(a[i].angle_step_rad, b[i].angle_step_rad);
    EXPECT_EQ(a[i].ranges_m, b[i].ranges_m);
    EXPECT_EQ(a[i].T_odom_robot, b[i].T_odom_robot);
    EXPECT_EQ(a[i].odometry_epoch, b[i].odometry_epoch);
  }
}

}  // namespace topogeo::recording
