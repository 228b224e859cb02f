#include "odometry_memory.hpp"

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <type_traits>

#include <fcntl.h>
#include <unistd.h>

#include "topogeo/support/file_content.hpp"
#include "topogeo/support/hash.hpp"

namespace topogeo::sensor_gateway {
namespace {

constexpr std::uint64_t kFormat = 0x314D4F4745475054;  // "TPGEGOM1": this layout

/// As it lies in the file, for this machine alone.
struct Record {
  std::uint64_t format = kFormat;
  std::uint64_t boot = 0;
  std::array<std::uint32_t, devices::kMcpFields> fields{};
  std::uint64_t mask = 0;
  std::int64_t arrival_ns = 0;
  double x_m = 0.0;
  double y_m = 0.0;
  double theta_rad = 0.0;
  std::uint64_t epoch = 0;
  std::uint64_t next_sequence = 0;
  std::int64_t last_stamp_ns = 0;
  std::uint64_t hash = 0;  // of all before
};
static_assert(std::is_trivially_copyable_v<Record> && sizeof(Record) % 8 == 0);
using RecordBytes = std::array<char, sizeof(Record)>;

std::uint64_t hash_of(const RecordBytes& bytes) {
  return support::fnv1a(std::string_view(bytes.data(), offsetof(Record, hash)));
}

/// The steady clock begins anew with the machine.
std::uint64_t this_boot() {
  static const std::uint64_t boot =
      support::fnv1a(support::file_content("/proc/sys/kernel/random/boot_id"));
  return boot;
}

support::FileDescriptor open_memory(const std::filesystem::path& path) {
  if (path.empty()) return support::FileDescriptor();
  support::FileDescriptor file(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644));
  if (!file.is_open()) {
    throw std::runtime_error(path.string() +
                             ": cannot be opened: " + std::generic_category().message(errno));
  }
  return file;
}

}  // namespace

OdometryMemory::OdometryMemory(const std::filesystem::path& path) : file_(open_memory(path)) {}

std::optional<RememberedOdometry> OdometryMemory::load() const {
  RecordBytes bytes{};
  if (!file_.is_open() || ::pread(file_.get(), bytes.data(), bytes.size(), 0) != sizeof(Record)) {
    return std::nullopt;
  }
  Record record;
  std::memcpy(&record, bytes.data(), bytes.size());
  if (record.format != kFormat || record.hash != hash_of(bytes) || record.boot != this_boot()) {
    return std::nullopt;
  }
  RememberedOdometry odometry;
  odometry.state.report.mask = static_cast<std::uint32_t>(record.mask);
  odometry.state.report.fields = record.fields;
  odometry.state.arrival_ns = record.arrival_ns;
  odometry.state.T_odom_robot = {record.x_m, record.y_m, record.theta_rad};
  odometry.epoch = record.epoch;
  odometry.next_sequence = record.next_sequence;
  odometry.last_stamp_ns = record.last_stamp_ns;
  return odometry;
}

void OdometryMemory::store(const RememberedOdometry& odometry) const {
  if (!file_.is_open()) return;
  Record record;
  record.boot = this_boot();
  record.mask = odometry.state.report.mask;
  record.fields = odometry.state.report.fields;
  record.arrival_ns = odometry.state.arrival_ns;
  record.x_m = odometry.state.T_odom_robot.x_m;
  record.y_m = odometry.state.T_odom_robot.y_m;
  record.theta_rad = odometry.state.T_odom_robot.theta_rad;
  record.epoch = odometry.epoch;
  record.next_sequence = odometry.next_sequence;
  record.last_stamp_ns = odometry.last_stamp_ns;
  RecordBytes bytes{};
  std::memcpy(bytes.data(), &record, bytes.size());
  record.hash = hash_of(bytes);
  std::memcpy(bytes.data(), &record, bytes.size());
  if (::pwrite(file_.get(), bytes.data(), bytes.size(), 0) != sizeof(Record)) {
    static_cast<void>(::ftruncate(file_.get(), 0));  // no half of it may pass for the whole
  }
}

}  // namespace topogeo::sensor_gateway
