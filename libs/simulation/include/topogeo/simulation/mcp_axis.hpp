// One motor of an emulated RWI base: runs, halts and goes given distances with the velocity and
// acceleration that was commanded, in the base's own counts.
#pragma once

#include <cstdint>

#include "topogeo/devices/mcp_protocol.hpp"

namespace topogeo::simulation {

class McpAxis {
 public:
  McpAxis(std::uint32_t velocity, std::uint32_t acceleration)
      : velocity_(velocity), acceleration_(acceleration) {}

  // Acts on a motion in progress, too.
  void set_velocity(std::uint32_t counts_per_s) { velocity_ = counts_per_s; }
  void set_acceleration(std::uint32_t counts_per_s2) { acceleration_ = counts_per_s2; }

  void run(int direction);  ///< +1 or -1
  void go(double counts);   ///< from where the encoder is
  void halt();
  void limp();
  /// By hand: follows this speed whatever was commanded, which it forgets.
  void follow(double counts_per_s);

  /// Lets time pass. Without power the wheels are braked, and the commands stay in force.
  void advance(double dt_s, bool power);
  /// What the encoder saw.
  void moved(double counts, double dt_s);

  /// Of the wheel, as the motor turns it; counts/s.
  [[nodiscard]] double speed() const { return speed_; }
  /// As the encoder saw it last.
  [[nodiscard]] double measured() const { return measured_; }
  [[nodiscard]] double position() const { return position_; }
  [[nodiscard]] bool moves() const { return speed_ != 0.0 || aim() != 0.0; }
  /// The word of the report.
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
