// One motor of an emulated RWI base: runs, halts and moves given distances with the commanded
// velocity and acceleration, in the base's own counts.
#pragma once

#include <cstdint>

#include "topogeo/devices/mcp_protocol.hpp"

namespace topogeo::simulation {

class McpAxis {
 public:
  McpAxis(std::uint32_t velocity, std::uint32_t acceleration)
      : velocity_(velocity), acceleration_(acceleration) {}

  // These also act on a motion in progress.
  void set_velocity(std::uint32_t counts_per_s) { velocity_ = counts_per_s; }
  void set_acceleration(std::uint32_t counts_per_s2) { acceleration_ = counts_per_s2; }

  void run(int direction);  ///< +1 or -1
  void go(double counts);   ///< from the present encoder position
  void halt();
  void limp();
  /// Driven by hand: follows this speed and forgets earlier commands.
  void follow(double counts_per_s);

  /// Lets time pass. Without power the wheels are braked, and the commands remain in force.
  void advance(double dt_s, bool power);
  /// Motion measured by the encoder.
  void moved(double counts, double dt_s);

  /// Speed of the wheel as driven by the motor; counts/s.
  [[nodiscard]] double speed() const { return speed_; }
  /// Speed last measured by the encoder.
  [[nodiscard]] double measured() const { return measured_; }
  [[nodiscard]] double position() const { return position_; }
  [[nodiscard]] bool moves() const { return speed_ != 0.0 || aim() != 0.0; }
  /// The status word of the report.
  [[nodiscard]] std::uint16_t status() const;

 private:
  enum class Mode : std::uint8_t { kStop, kRun, kGo, kHalt, kLimp, kFollow };

  [[nodiscard]] double aim() const;
  [[nodiscard]] devices::McpPhase phase() const;

  std::uint32_t velocity_;
  std::uint32_t acceleration_;
  Mode mode_ = Mode::kStop;
  int direction_ = 1;
  double followed_ = 0.0;
  double remaining_ = 0.0;  // of kGo, always ahead in direction_
  double speed_ = 0.0;
  double measured_ = 0.0;
  double position_ = 0.0;
};

}  // namespace topogeo::simulation
