#include "odometry_memory.hpp"

#include <array>

#include "topogeo/support/host.hpp"

namespace topogeo::sensor_gateway {
namespace {

constexpr std::uint64_t kFormat = 0x324D4F4745475054;  // "TPGEGOM2": the layout of OdometryRecord

}  // namespace

OdometryMemory::OdometryMemory(const std::filesystem::path& path) : file_(path, kFormat) {}

std::optional<RememberedOdometry> OdometryMemory::load() const {
  const std::optional<OdometryRecord> record = file_.load();
  if (!record || record->boot != support::this_boot()) return std::nullopt;
  RememberedOdometry odometry;
  odometry.state.report.mask = static_cast<std::uint32_t>(record->mask);
  odometry.state.report.fields = record->fields;
  odometry.state.arrival_ns = record->arrival_ns;
  odometry.state.T_odom_robot = {record->x_m, record->y_m, record->theta_rad};
  odometry.epoch = record->epoch;
  odometry.next_sequence = record->next_sequence;
  odometry.last_stamp_ns = record->last_stamp_ns;
  return odometry;
}

void OdometryMemory::store(const RememberedOdometry& odometry) const {
  OdometryRecord record;
  record.boot = support::this_boot();
  record.mask = odometry.state.report.mask;
  record.fields = odometry.state.report.fields;
  record.arrival_ns = odometry.state.arrival_ns;
  record.x_m = odometry.state.T_odom_robot.x_m;
  record.y_m = odometry.state.T_odom_robot.y_m;
  record.theta_rad = odometry.state.T_odom_robot.theta_rad;
  record.epoch = odometry.epoch;
  record.next_sequence = odometry.next_sequence;
  record.last_stamp_ns = odometry.last_stamp_ns;
  static_cast<void>(file_.store(record));
}

}  // namespace topogeo::sensor_gateway
