#include "topogeo/storage/tum.hpp"

#include <array>
#include <cmath>
#include <stdexcept>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/support/atomic_file.hpp"
#include "topogeo/support/file_content.hpp"
#include "topogeo/support/format.hpp"

#include "text_fields.hpp"

namespace topogeo::storage {
namespace {

constexpr std::int64_t kStampSecond_ns = 1'000'000'000;

/// Fixed decimals, without a minus if the value rounds to zero.
std::string fixed(double value, int decimals) {
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (text.find_first_not_of("-0.") == std::string::npos && text.starts_with('-')) text.erase(0, 1);
  return text;
}

/// Heading of a rotation given by a quaternion of any length above zero.
double heading_rad(double qx, double qy, double qz, double qw) {
  return geometry::atan2(2.0 * (qw * qz + qx * qy), qw * qw + qx * qx - qy * qy - qz * qz);
}

topomap::StampedPose parse_pose(std::string_view line, const std::string& where) {
  static constexpr std::array<const char*, 7> kNames{"x", "y", "z", "qx", "qy", "qz", "qw"};
  const std::int64_t stamp_ns = take_stamp(line, where, "stamp");
  std::array<double, 7> values{};
  take_numbers(line, where, kNames, "t x y z qx qy qz qw", values);
  const auto [x, y, z, qx, qy, qz, qw] = values;
  static_cast<void>(z);
  const double norm = qx * qx + qy * qy + qz * qz + qw * qw;
  if (!(norm > 0.5 && norm < 2.0)) {
    throw std::runtime_error(
        fmt::format("{}: quaternion of squared length {}: expected 1", where, norm));
  }
  return {0, stamp_ns, {x, y, heading_rad(qx, qy, qz, qw)}};
}

}  // namespace

std::string stamp_text(std::int64_t stamp_ns) {
  // Unsigned, because the most negative stamp has no positive counterpart.
  const std::uint64_t magnitude = stamp_ns < 0 ? 0 - static_cast<std::uint64_t>(stamp_ns)
                                               : static_cast<std::uint64_t>(stamp_ns);
  const std::uint64_t seconds = magnitude / static_cast<std::uint64_t>(kStampSecond_ns);
  const std::uint64_t ns = magnitude % static_cast<std::uint64_t>(kStampSecond_ns);
  const char* sign = stamp_ns < 0 ? "-" : "";
  if (ns % 1000 == 0) return fmt::format("{}{}.{:06}", sign, seconds, ns / 1000);
  return fmt::format("{}{}.{:09}", sign, seconds, ns);
}

std::string trajectory_tum(std::span<const topomap::StampedPose> poses) {
  std::string text;
  for (const topomap::StampedPose& p : poses) {
    if (!std::isfinite(p.pose.x_m) || !std::isfinite(p.pose.y_m) ||
        !std::isfinite(p.pose.theta_rad)) {
      throw std::invalid_argument(
          fmt::format("trajectory: pose of scan {} is not finite", p.sequence));
    }
    const auto half = geometry::sincos(0.5 * p.pose.theta_rad);
    text += fmt::format("{} {} {} {} 0.000000000 0.000000000 {} {}\n", stamp_text(p.stamp_ns),
                        fixed(p.pose.x_m, 6), fixed(p.pose.y_m, 6), "0.000000", fixed(half.sin, 9),
                        fixed(half.cos, 9));
  }
  return text;
}

void write_trajectory_tum(const std::filesystem::path& path,
                          std::span<const topomap::StampedPose> poses) {
  support::write_file_atomically(path, trajectory_tum(poses));
}

std::vector<topomap::StampedPose> parse_trajectory_tum(std::string_view text,
                                                       const std::string& name) {
  std::vector<topomap::StampedPose> poses;
  for_each_line(text, name, [&](std::string_view line, const std::string& where) {
    poses.push_back(parse_pose(line, where));
    poses.back().sequence = poses.size() - 1;
  });
  return poses;
}

std::vector<topomap::StampedPose> read_trajectory_tum(const std::filesystem::path& path) {
  return parse_trajectory_tum(support::file_content(path), path.string());
}

}  // namespace topogeo::storage
