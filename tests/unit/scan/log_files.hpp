// Log files made by tests, removed at their end.
#pragma once

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>
#include <zlib.h>

#include "topogeo/scan/carmen_log_reader.hpp"

namespace topogeo::scan {

class LogFiles : public ::testing::Test {
 protected:
  LogFiles() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() /
              ("topogeo_scan_" + std::string(test->name()) + "_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
  }
  ~LogFiles() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path path(const std::string& name) const { return folder_ / name; }

  std::filesystem::path plain(const std::string& content, const std::string& name = "a.clf") const {
    std::ofstream(path(name), std::ios::binary) << content;
    return path(name);
  }

  std::filesystem::path gzip(const std::string& content,
                             const std::string& name = "a.clf.gz") const {
    gzFile file = gzopen(path(name).c_str(), "wb");
    EXPECT_EQ(gzwrite(file, content.data(), static_cast<unsigned>(content.size())),
              static_cast<int>(content.size()));
    EXPECT_EQ(gzclose(file), Z_OK);
    return path(name);
  }

 private:
  std::filesystem::path folder_;
};

/// A valid FLASER line of four beams; its odometry x is the first digit of the stamp.
inline std::string flaser(const std::string& stamp,
                          const std::string& ranges = "1.00 2.00 3.00 4.00", int count = 4,
                          const std::string& x_m = "") {
  std::ostringstream line;
  line << "FLASER " << count << ' ' << ranges << " 9 9 9 "
       << (x_m.empty() ? stamp.substr(0, 1) : x_m) << " 0.5 0.25 " << stamp << " host " << stamp
       << '\n';
  return line.str();
}

inline std::string content_of(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

inline std::vector<Scan> read_all(CarmenLogReader& reader) {
  std::vector<Scan> scans;
  while (auto scan = reader.next()) scans.push_back(*std::move(scan));
  return scans;
}

/// Message of the exception on opening the log; empty when it opens.
inline std::string open_error(const std::filesystem::path& path) {
  try {
    const CarmenLogReader reader(path);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return {};
}

}  // namespace topogeo::scan
