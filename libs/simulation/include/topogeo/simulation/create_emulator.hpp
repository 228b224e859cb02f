// An iRobot Create 2 with its Open Interface: modes, stream, and wheels that obey the last speeds
// for ever.
#pragma once

#include <cstdint>
#include <deque>
#include <span>

#include "topogeo/devices/create_protocol.hpp"
#include "topogeo/devices/create_settings.hpp"
#include "topogeo/simulation/two_wheel_emulator.hpp"

namespace topogeo::simulation {

struct CreateEmulatorSettings {
  devices::LineSettings line{115'200, devices::Parity::kNone};
  devices::CreateSettings wheels{};
  double battery_v = 15.5;
  std::uint16_t charge_mah = 1'950;
  std::uint16_t capacity_mah = 2'600;  ///< 0: the battery does not know it
  unsigned mode_offset = 0;            ///< a Roomba 690 counts its modes from one more
  std::uint64_t seed = 1;
};

class CreateEmulator final : public TwoWheelEmulator {
 public:
  /// Switched on at `now_ns`, in the mode off.
  explicit CreateEmulator(const CreateEmulatorSettings& settings, std::int64_t now_ns = 0);

  void press_bumpers(std::uint16_t pressed, std::int64_t now_ns) override;
  /// Somebody lifts the robot: its wheels drop.
  void press_emergency_stop() override { hang_wheels(true); }
  void release_emergency_stop() override { hang_wheels(false); }

  void hang_wheels(bool hang);
  /// One of the front sensors sees no floor.
  void set_cliff(bool cliff);
  void set_dock(bool dock);
  /// For another reason.
  void leave_safe_mode();
  [[nodiscard]] devices::CreateMode mode() const { return mode_; }

 private:
  void obey(std::span<const std::uint8_t> bytes, std::int64_t now_ns) override;
  void report(std::int64_t now_ns) override;
  void forget() override;

  /// Takes the first order from `orders_`; false if its data have not come yet.
  bool obey_first();
  void obey_order(std::uint8_t order, std::span<const std::uint8_t> data);
  void drive(double left_mmps, double right_mmps);
  /// The motors stop.
  void become(devices::CreateMode mode);
  /// Falls to the passive mode if something forbids the safe one.
  void check_safety();
  /// A cleaning program drives the robot.
  void clean();

  CreateEmulatorSettings create_;
  devices::CreateReport seen_;  // what the sensors see
  devices::CreateMode mode_ = devices::CreateMode::kOff;
  bool streams_ = false;
  std::deque<std::uint8_t> orders_;
};

}  // namespace topogeo::simulation
