// Validity of a motion command: a velocity holds until a deadline, a relative move until it has
// ended or its deadline has passed.
#pragma once

#include <cstdint>
#include <optional>

#include "topogeo/devices/base_settings.hpp"

namespace topogeo::devices {

class MotionTerm {
 public:
  explicit MotionTerm(const BaseSettings& settings);

  /// No command holds any more.
  void clear();
  /// A velocity holds until `valid_until_ns`, but at most for settings.command_timeout_s.
  void start_velocity(std::int64_t valid_until_ns, std::int64_t now_ns);
  void start_relative(std::int64_t valid_until_ns) { relative_ = Relative{valid_until_ns, {}}; }
  /// All commands of the relative move were sent; only the first call counts.
  void relative_sent(std::int64_t now_ns);

  [[nodiscard]] bool velocity_holds() const { return velocity_until_ns_.has_value(); }
  [[nodiscard]] bool relative_holds() const { return relative_.has_value(); }
  /// The deadline has passed.
  [[nodiscard]] bool expired(std::int64_t now_ns) const { return now_ns >= due_ns(); }
  /// The relative move has ended: the base had time to start it, and has stood for enough reports.
  [[nodiscard]] bool relative_ended(unsigned reports_standing, std::int64_t now_ns) const;
  /// The deadline; the largest number if no command holds.
  [[nodiscard]] std::int64_t due_ns() const;

 private:
  struct Relative {
    std::int64_t until_ns = 0;
    std::optional<std::int64_t> sent_ns{};
  };

  std::int64_t command_timeout_ns_;
  std::int64_t begun_ns_;  // time between the commands and the first report of their effect
  std::optional<std::int64_t> velocity_until_ns_{};
  std::optional<Relative> relative_{};
};

}  // namespace topogeo::devices
