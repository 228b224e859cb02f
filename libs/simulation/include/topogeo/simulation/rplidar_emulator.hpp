// A Slamtec RPLIDAR at the other end of a serial line: answers requests, and sends the samples of a
// standard, express or dense scan once it was asked to. It takes the motor for running.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "topogeo/devices/rplidar_protocol.hpp"
#include "topogeo/devices/serial_driver.hpp"
#include "topogeo/simulation/turning_emulator.hpp"

namespace topogeo::simulation {

struct RpLidarEmulatorSettings {
  devices::LineSettings line{115'200, devices::Parity::kNone};
  double turns_hz = 5.5;       ///< (0, 100]
  double samples_hz = 3960.0;  ///< of packets; a standard scan has half of it
  double range_max_m = 12.0;
  std::uint8_t model = 0x18;  ///< that it reports
  std::uint8_t health = 0;    ///< 0 good, 1 warning, 2 error until a reset
  std::uint16_t error_code = 0;
  bool knows_sample_rate = true;  ///< old firmware does not answer that request
  /// Answer to an express request by its working mode 0 and 1.
  std::uint8_t mode_type[2] = {devices::rp_answer::kExpress, devices::rp_answer::kDense};
  std::int64_t answer_ns = 2'000'000;        ///< from a request to its answer
  std::int64_t start_up_ns = 1'000'000'000;  ///< after a reset or power-on
  std::uint64_t seed = 1;                    ///< of the places of faults
};

class RpLidarEmulator final : public TurningEmulator {
 public:
  /// A laser that was switched on long before `now_ns` and waits for requests. Throws
  /// std::invalid_argument for invalid settings.
  RpLidarEmulator(const RpLidarEmulatorSettings& settings, Ranges ranges, std::int64_t now_ns = 0);

  void receive(std::span<const std::uint8_t> bytes, const devices::LineSettings& host,
               std::int64_t now_ns) override;
  void switch_off() override;
  void switch_on(std::int64_t now_ns) override;
  /// Type of the scan that it sends; 0: none.
  [[nodiscard]] std::uint8_t scans() const { return scan_type_; }
  /// The last value of a request for the motor, and its command; 0: none.
  [[nodiscard]] std::uint8_t motor_command() const { return motor_command_; }
  [[nodiscard]] std::uint16_t motor_value() const { return motor_value_; }

 private:
  void obey(std::uint8_t command, std::span<const std::uint8_t> payload, std::int64_t now_ns);
  void describe(const devices::RpDescriptor& descriptor, std::span<const std::uint8_t> data,
                std::int64_t now_ns);
  void start_scan(std::uint8_t type, std::int64_t now_ns);
  void send_packet() override;

  RpLidarEmulatorSettings settings_;
  std::vector<std::uint8_t> request_;
  std::uint8_t scan_type_ = 0;
  bool first_ = false;         // the next packet is the first of its scan
  bool turned_ = false;        // the next sample is the first of a turn
  std::int64_t ready_ns_ = 0;  // end of the start-up
  double angle_deg_ = 0.0;     // of the next sample, clockwise
  bool off_ = false;
  std::uint8_t motor_command_ = 0;
  std::uint16_t motor_value_ = 0;
};

}  // namespace topogeo::simulation
