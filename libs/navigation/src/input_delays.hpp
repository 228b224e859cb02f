// Distinguishes an input that has ceased from one that is late because a machine is too busy.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "topogeo/navigation/navigator_inputs.hpp"

namespace topogeo::navigation {

class InputDelays {
 public:
  /// A message with this stamp came at `arrival_ns`.
  void add(TimedInput input, std::int64_t stamp_ns, std::int64_t arrival_ns);
  void set(const MachineLoad& load) { load_ = load; }

  /// The text of the reason for a halt, and whether a busy machine is part of it. An input that is
  /// late is named with its delay (scans and odometry replace `message`), a busy machine with any
  /// other reason that it can cause.
  struct Reason {
    std::string message;
    bool busy_machine = false;
  };
  [[nodiscard]] Reason explain(HaltReason reason, std::string message, std::int64_t now_ns) const;

 private:
  struct Newest {
    std::int64_t stamp_ns = 0;
    std::int64_t arrival_ns = 0;
  };
  [[nodiscard]] std::optional<double> delay_s(TimedInput input, std::int64_t now_ns) const;

  std::array<std::optional<Newest>, kTimedInputs> newest_;
  MachineLoad load_;
};

}  // namespace topogeo::navigation
