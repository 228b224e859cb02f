#include "topogeo/scan/carmen_log_writer.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <numbers>
#include <stdexcept>
#include <string>

#include <zlib.h>

#include "topogeo/scan/carmen_log_reader.hpp"

namespace topogeo::scan {
namespace {

// The shortest text that reads back as the same number.
template <typename T>
void append(std::string& text, T value) {
  std::array<char, 64> digits{};
  const auto result = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  text += ' ';
  text.append(digits.data(), result.ptr);
}

void append_pose(std::string& text, const geometry::Pose2& pose) {
  append(text, pose.x_m);
  append(text, pose.y_m);
  append(text, pose.theta_rad);
}

void append_stamp(std::string& text, std::int64_t stamp_ns) {
  const std::string nanoseconds = std::to_string(stamp_ns % 1'000'000'000);
  append(text, stamp_ns / 1'000'000'000);
  text += '.';
  text.append(9 - nanoseconds.size(), '0');
  text += nanoseconds;
}

/// Start of a ROBOTLASER1 line, before its readings; laser type 0 is a SICK LMS.
void append_geometry(std::string& text, const Scan& scan) {
  text += "ROBOTLASER1 0";
  append(text, scan.angle_min_rad);
  append(text, scan.angle_step_rad * static_cast<double>(scan.ranges_m.size() - 1));
  append(text, scan.angle_step_rad);
  append(text, CarmenLogWriter::kNoReturnWritten_m);
  text += " 0.01 0";  // accuracy in metres, no remission
}

void check(const Scan& scan) {
  static_assert(CarmenLogReader::kMaxBeams == 2048, "named in a message below");
  constexpr double kTurn_rad = 2.0 * std::numbers::pi + 0.01;
  constexpr double kFinest_rad = 1e-5;
  if (scan.ranges_m.size() < 2 || scan.ranges_m.size() > CarmenLogReader::kMaxBeams) {
    throw std::invalid_argument("ranges_m: expected 2 to 2048 ranges, got " +
                                std::to_string(scan.ranges_m.size()));
  }
  const double view_rad = scan.angle_step_rad * static_cast<double>(scan.ranges_m.size() - 1);
  if (!(std::fabs(scan.angle_min_rad) <= kTurn_rad) || !(scan.angle_step_rad >= kFinest_rad) ||
      !(view_rad <= kTurn_rad)) {
    throw std::invalid_argument(
        "angle_min_rad, angle_step_rad: expected a step of 0.00001 or more, all within one turn, "
        "got " +
        std::to_string(scan.angle_min_rad) + ", " + std::to_string(scan.angle_step_rad));
  }
  if (scan.stamp_ns < 0) {
    throw std::invalid_argument("stamp_ns: expected a number >= 0, got " +
                                std::to_string(scan.stamp_ns));
  }
  const auto bad = std::find_if(scan.ranges_m.begin(), scan.ranges_m.end(),
                                [](float r) { return !(std::isfinite(r) && r >= 0.0F); });
  if (bad != scan.ranges_m.end()) {
    throw std::invalid_argument("ranges_m[" + std::to_string(bad - scan.ranges_m.begin()) +
                                "]: expected a finite range >= 0, got " + std::to_string(*bad));
  }
}

}  // namespace

double flaser_angle_step_rad(std::size_t beams) {
  const std::size_t steps = beams % 2 == 1 ? beams - 1 : beams;
  return std::numbers::pi / static_cast<double>(steps);
}

struct CarmenLogWriter::Impl {
  Impl(std::string name, const char* mode, const geometry::Pose2& mounting)
      : path(std::move(name)), T_robot_laser(mounting) {
    errno = 0;
    file = gzopen(path.c_str(), mode);
    if (file == nullptr) fail(errno != 0 ? std::strerror(errno) : "no memory");
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() {
    if (file != nullptr) gzclose(file);
  }
  [[noreturn]] void fail(const std::string& why) const {
    throw std::runtime_error(path + ": cannot write: " + why);
  }
  void put(const std::string& text) {
    errno = 0;
    if (file == nullptr) fail("already closed");
    if (gzwrite(file, text.data(), static_cast<unsigned>(text.size())) !=
        static_cast<int>(text.size())) {
      fail(errno != 0 ? std::strerror(errno) : "compression failed");
    }
  }

  std::string path;
  geometry::Pose2 T_robot_laser;
  gzFile file = nullptr;
};

CarmenLogWriter::CarmenLogWriter(const std::filesystem::path& path,
                                 const geometry::Pose2& T_robot_laser)
    : impl_(std::make_unique<Impl>(path.string(), path.extension() == ".gz" ? "wb" : "wbT",
                                   T_robot_laser)) {
  impl_->put(
      "# FLASER num_readings [range_readings] x y theta odom_x odom_y odom_theta ipc_timestamp "
      "ipc_hostname logger_timestamp\n");
}

CarmenLogWriter::~CarmenLogWriter() = default;
CarmenLogWriter::CarmenLogWriter(CarmenLogWriter&&) noexcept = default;
CarmenLogWriter& CarmenLogWriter::operator=(CarmenLogWriter&&) noexcept = default;

void CarmenLogWriter::write(const Scan& scan) {
  check(scan);
  // Exact comparison, so that reading back gives the written scan.
  const bool flaser = scan.angle_min_rad == -std::numbers::pi / 2.0 &&
                      scan.angle_step_rad == flaser_angle_step_rad(scan.ranges_m.size());
  std::string line;
  if (flaser) {
    line += "FLASER";
  } else {
    append_geometry(line, scan);
  }
  append(line, scan.ranges_m.size());
  for (const float range_m : scan.ranges_m) {
    append(line, range_m == Scan::kNoReturn ? kNoReturnWritten_m : range_m);
  }
  if (!flaser) line += " 0";  // remission values
  // Without a mounting the robot's pose unchanged, because a product would wrap its heading.
  const bool mounted = impl_->T_robot_laser != geometry::Pose2{};
  append_pose(line, mounted ? scan.T_odom_robot * impl_->T_robot_laser : scan.T_odom_robot);
  append_pose(line, scan.T_odom_robot);
  if (!flaser) line += " 0 0 0 0 0";  // unknown: speeds, safety distances, turn axis
  append_stamp(line, scan.stamp_ns);
  line += " topogeo";
  append_stamp(line, scan.stamp_ns);
  line += '\n';
  impl_->put(line);
}

void CarmenLogWriter::close() {
  if (impl_->file == nullptr) return;
  errno = 0;
  const int code = gzclose(impl_->file);
  impl_->file = nullptr;
  if (code != Z_OK) impl_->fail(errno != 0 ? std::strerror(errno) : "compression failed");
}

}  // namespace topogeo::scan
