#include "base_drive.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "checks.hpp"

namespace topogeo::fuzz {

std::size_t drive_base(
    const devices::BaseSettings& settings, std::span<const std::uint8_t> bytes,
    const std::function<void(const std::vector<devices::LineOrder>& orders)>& check_orders) {
  constexpr std::int64_t kRead_ns = 20'000'000;
  constexpr std::size_t kRead_bytes = 61;
  const auto driver = devices::make_base_driver(settings);
  std::int64_t now_ns = 0;
  std::int64_t stamp_ns = std::numeric_limits<std::int64_t>::min();
  std::size_t reports = 0;
  driver->opened(now_ns);
  for (std::size_t at = 0; at < bytes.size(); at += kRead_bytes) {
    now_ns += kRead_ns;
    driver->receive(bytes.subspan(at, std::min(kRead_bytes, bytes.size() - at)), now_ns);
    driver->tick(now_ns);
    (void)driver->command(0.1, 0.1, now_ns + kRead_ns, now_ns);
    require(driver->due_ns() > now_ns, "a driver does not ask for the time that is");
    check_orders(driver->take_orders());
    for (const devices::BaseOdometry& odometry : driver->take_odometry()) {
      require(odometry.stamp_ns > stamp_ns, "stamps increase");
      stamp_ns = odometry.stamp_ns;
      ++reports;
      const geometry::Pose2& pose = odometry.T_odom_robot;
      require(std::isfinite(pose.x_m) && std::isfinite(pose.y_m) && std::isfinite(pose.theta_rad),
              "the odometry is finite");
    }
  }
  return reports;
}

}  // namespace topogeo::fuzz
