// Base of emulated lasers that measure one beam after the other while they turn, and send packets
// of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "topogeo/devices/serial_driver.hpp"
#include "topogeo/simulation/laser_emulator.hpp"
#include "topogeo/simulation/serial_output.hpp"
#include "topogeo/simulation/telegram_faults.hpp"

namespace topogeo::simulation {

class TurningEmulator : public LaserEmulator {
 public:
  void tick(std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t due_ns() const override { return next_ns_; }
  [[nodiscard]] std::vector<std::uint8_t> take_output(const devices::LineSettings& host,
                                                      std::int64_t now_ns) override;
  void switch_off() override;
  void fall_silent(std::int64_t now_ns) override;
  void speak_again(std::int64_t now_ns) override;
  void set_fault(LaserFault fault, bool on) override { faults_.set(fault, on); }
  [[nodiscard]] std::uint64_t scans_sent() const override { return turns_; }

  [[nodiscard]] TelegramFaults& faults() { return faults_; }
  /// Changes the mean speed, which the motor reaches after a while; (0, 100].
  void set_turns_hz(double turns_hz) { motor_.turns_hz = turns_hz; }

 protected:
  static constexpr double kTurn_deg = 360.0;
  /// Time of the next packet while none is due.
  static constexpr std::int64_t kNever_ns = std::numeric_limits<std::int64_t>::max();

  struct Motor {
    double turns_hz = 0.0;    ///< (0, 100]
    double samples_hz = 0.0;  ///< measurements a second, > 0
    double wobble = 0.0;      ///< largest relative error of the speed; [0, 1)
    bool clockwise = true;
  };
  /// The laser sends at this rate of the line, sees up to `range_max_m`, and `seed` draws the
  /// places of its faults. Throws std::invalid_argument for values out of range or without ranges.
  TurningEmulator(const devices::LineSettings& line, const Motor& motor, double range_max_m,
                  std::uint64_t seed, Ranges ranges);

  /// Sends the packet that is due, and schedules the next one.
  virtual void send_packet() = 0;

  [[nodiscard]] bool is_silent() const { return silent_; }
  [[nodiscard]] std::int64_t next_ns() const { return next_ns_; }
  void schedule(std::int64_t next_ns) { next_ns_ = next_ns; }

  /// Speed at next_ns(), turns a second, after `samples` more measurements since the last call.
  [[nodiscard]] double turn_motor(std::size_t samples);
  /// Readings of `count` beams in the order of their measurement, taken at next_ns(), in whole
  /// millimetres; 0: no return. `first_deg`: from the x axis of the laser, in its sense.
  [[nodiscard]] std::vector<double> measure_mm(double first_deg, double step_deg,
                                               std::size_t count) const;
  /// A laser whose receiver lies beside the axis.
  struct BesideAxis {
    /// Direction of a return from the angle that the laser states, degrees in its sense.
    std::function<double(double reading_mm)> aside_deg;
    /// Reading of a range from the centre of the laser, millimetres.
    std::function<double(double range_mm)> reading_mm;
  };
  /// The same for a laser beside its axis, at the angles that it states.
  [[nodiscard]] std::vector<double> measure_aside_mm(double first_deg, double step_deg,
                                                     std::size_t count,
                                                     const BesideAxis& geometry) const;
  /// Sends a packet of readings, with faults, at next_ns().
  void send(std::vector<std::uint8_t> packet);
  /// Sends an answer, without faults, at a time.
  void answer(std::vector<std::uint8_t> bytes, std::int64_t at_ns);
  /// A turn was completed.
  void count_turn() { turns_ += silent_ ? 0 : 1; }

 private:
  devices::LineSettings line_;
  Motor motor_;
  double mean_hz_;  // present mean speed
  double range_max_m_;
  Ranges ranges_;
  SerialOutput output_;
  TelegramFaults faults_;
  std::int64_t next_ns_ = kNever_ns;  // time of the last beam of the next packet
  bool silent_ = false;
  std::uint64_t turns_ = 0;
};

}  // namespace topogeo::simulation
