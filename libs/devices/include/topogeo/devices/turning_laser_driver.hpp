// The common part of drivers of lasers that send packets without further requests: the port, orders
// that start the laser, silence and restart, and the scans of whole turns.
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "topogeo/devices/laser_driver.hpp"
#include "topogeo/devices/laser_models.hpp"
#include "topogeo/devices/turn_assembler.hpp"
#include "topogeo/devices/turning_laser_settings.hpp"

namespace topogeo::devices {

class TurningLaserDriver : public LaserDriver {
 public:
  void opened(std::int64_t now_ns) override;
  void lost(std::int64_t now_ns) override;
  void receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns) override;
  void tick(std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t due_ns() const override;
  [[nodiscard]] std::vector<LineOrder> take_orders() override;
  [[nodiscard]] std::vector<LaserScan> take_scans() override;
  [[nodiscard]] LaserHealth health() const override;
  void end(std::int64_t now_ns) override;

 protected:
  using Drops = std::vector<std::pair<std::string, std::uint64_t>>;
  /// Bytes that start the laser, written so long after the port was opened or the laser fell
  /// silent.
  struct StartStep {
    std::int64_t after_ns = 0;
    LineOrder order;
  };

  /// `clockwise`: sense of the laser's rotation, seen from above when it stands upright. Throws
  /// std::invalid_argument when a setting is out of range.
  TurningLaserDriver(const LaserModel& model, const TurningLaserSettings& settings, bool clockwise);

  /// Passes received bytes to the decoder, which calls heard() and add_beam().
  virtual void decode(std::span<const std::uint8_t> bytes, std::int64_t now_ns) = 0;
  /// The port was opened: drops what was received so far.
  virtual void restart() = 0;
  /// The next packet follows no earlier one.
  virtual void interrupt() = 0;
  /// In the order of their times; none for a laser that sends as soon as it has power.
  [[nodiscard]] virtual std::vector<StartStep> start_steps() const { return {}; }
  [[nodiscard]] virtual std::vector<LineOrder> end_orders() const { return {}; }
  /// Turns a second that the running laser reports; 0: unknown.
  [[nodiscard]] virtual double turns_hz() const = 0;
  [[nodiscard]] virtual Drops drops() const = 0;
  /// Completes the health by what only this kind of laser reports.
  virtual void complete(LaserHealth& health) const { static_cast<void>(health); }

  /// A packet of the laser arrived.
  void heard(std::int64_t arrival_ns) { waits_since_ns_ = arrival_ns; }
  /// The next beam in order of time. `time_ns` is that of the measurement on the host's clock
  /// before the packet delay of the settings, which this subtracts.
  void add_beam(TurningBeam beam);
  /// The next beam follows no earlier one.
  void restart_turn() { turns_.restart(); }

  [[nodiscard]] const LaserModel& model() const { return model_; }
  [[nodiscard]] const TurningLaserSettings& settings() const { return settings_; }
  [[nodiscard]] const LineSettings& line() const { return line_; }

 private:
  void start(std::int64_t now_ns);
  void wait(LaserState state, std::string reason);
  [[nodiscard]] std::int64_t failed_after_ns() const;

  const LaserModel& model_;
  TurningLaserSettings settings_;
  LineSettings line_;
  TurnAssembler turns_;

  LaserState state_ = LaserState::kOffline;
  std::string reason_;
  std::int64_t waits_since_ns_ = 0;  // for a packet
  std::int64_t last_byte_ns_ = 0;
  std::uint64_t silences_ = 0;
  std::deque<StartStep> steps_;  // still to be written; after_ns on the host's clock
  std::int64_t started_ns_ = 0;  // when start_steps() were given
  std::vector<LineOrder> orders_;
  std::vector<LaserScan> scans_;
};

}  // namespace topogeo::devices
