#include "pose_memory.hpp"

#include <algorithm>
#include <bit>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/support/hash.hpp"

namespace topogeo::localizer {

namespace {

constexpr std::uint64_t kFormat = 0x31535045474F5054;  // "TPOGEPS1": the layout of Record

std::array<double, 3> numbers_of(const geometry::Pose2& pose) {
  return {pose.x_m, pose.y_m, pose.theta_rad};
}

geometry::Pose2 pose_of(const std::array<double, 3>& numbers) {
  return {numbers[0], numbers[1], numbers[2]};
}

/// Identifies the frame of a map: equal for two maps with the same stops at the same poses. Never
/// 0.
std::uint64_t frame_of(const localization::StoredMap& map) {
  support::Fnv1a hash;
  for (const topomap::StopPose& stop : map.trajectory.stops) {
    hash.add(stop.stop.session);
    hash.add(std::uint64_t{stop.stop.number});
    for (const double value : numbers_of(stop.T_map_robot)) {
      hash.add(std::bit_cast<std::uint64_t>(value));
    }
  }
  return std::max<std::uint64_t>(hash.value(), 1);
}

}  // namespace

PoseMemory::PoseMemory(const std::filesystem::path& path, const localization::StoredMap& map)
    : file_(path, kFormat), map_(frame_of(map)) {}

std::optional<RememberedPlace> PoseMemory::load() const {
  const std::optional<Record> record = file_.load();
  if (!record || record->map != map_) return std::nullopt;
  RememberedPlace out;
  out.stop = {record->session, static_cast<std::uint32_t>(record->number)};
  out.place.odometry_epoch = record->odometry_epoch;
  out.place.T_odom_robot = pose_of(record->T_odom_robot);
  out.place.T_map_robot.T_a_b = pose_of(record->T_map_robot);
  std::ranges::copy(record->covariance, out.place.T_map_robot.covariance.reshaped().begin());
  return out;
}

void PoseMemory::store(const RememberedPlace& remembered) const {
  Record record;
  record.map = map_;
  record.session = remembered.stop.session;
  record.number = remembered.stop.number;
  record.odometry_epoch = remembered.place.odometry_epoch;
  record.T_odom_robot = numbers_of(remembered.place.T_odom_robot);
  record.T_map_robot = numbers_of(remembered.place.T_map_robot.T_a_b);
  std::ranges::copy(remembered.place.T_map_robot.covariance.reshaped(), record.covariance.begin());
  static_cast<void>(file_.store(record));
}

}  // namespace topogeo::localizer
