// A pair of VESC motor controllers: one at the port, the other on its CAN bus. Each releases its
// motor when its timeout has passed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "topogeo/devices/vesc_protocol.hpp"
#include "topogeo/devices/vesc_settings.hpp"
#include "topogeo/simulation/two_wheel_emulator.hpp"

namespace topogeo::simulation {

struct VescEmulatorSettings {
  devices::LineSettings line{115'200, devices::Parity::kNone};
  devices::VescSettings wheels{};
  double battery_v = 24.6;
  std::int64_t timeout_ns = 1'000'000'000;  ///< without a command until a motor is released
  std::uint64_t seed = 1;
};

class VescEmulator final : public TwoWheelEmulator {
 public:
  /// Switched on at `now_ns`.
  explicit VescEmulator(const VescEmulatorSettings& settings, std::int64_t now_ns = 0);

  void tick(std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t due_ns() const override;
  void stand_still(std::int64_t duration_ns) override;
  void press_bumpers(std::uint16_t /*pressed*/, std::int64_t /*now_ns*/) override {}
  /// The motors lose their power, which is an undervoltage.
  void press_emergency_stop() override { set_fault_code(2); }
  void release_emergency_stop() override { set_fault_code(0); }

  void set_fault_code(std::uint8_t fault) { fault_ = fault; }
  /// The other controller is off the CAN bus.
  void cut_can_bus(bool cut) { can_cut_ = cut; }

 private:
  void obey(std::span<const std::uint8_t> bytes, std::int64_t now_ns) override;
  /// It answers only.
  void report(std::int64_t /*now_ns*/) override {}
  void forget() override;
  [[nodiscard]] bool motors_on() const override { return fault_ == 0; }

  void obey_packet(std::size_t wheel, const devices::VescPacket& packet, std::int64_t now_ns);
  void answer(std::size_t wheel, std::int64_t now_ns);
  void drive();
  [[nodiscard]] std::size_t wheel_at_port() const { return vesc_.wheels.port_is_right ? 1 : 0; }
  [[nodiscard]] int direction(std::size_t wheel) const;

  VescEmulatorSettings vesc_;
  devices::VescReader reader_;
  std::array<std::int32_t, 2> erpm_{};  // of the wheels
  std::array<std::int64_t, 2> commanded_ns_{};
  std::uint8_t fault_ = 0;
  bool can_cut_ = false;
};

}  // namespace topogeo::simulation
