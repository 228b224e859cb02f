// The sonars of a Pioneer, which its base reads in turns and reports a few at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "topogeo/devices/body_sensors.hpp"
#include "topogeo/devices/pioneer_protocol.hpp"

namespace topogeo::devices {

class PioneerSonars final : public BodySensors {
 public:
  /// `units_per_m` of the ranges, > 0.
  explicit PioneerSonars(double units_per_m) : units_per_m_(units_per_m) {}

  /// New ones; those of unknown sonars are skipped.
  void take(std::span<const PioneerEcho> echoes, std::int64_t now_ns);

  /// The last range of each sonar in the order of pioneer_sonars(), front ring or both; nothing if
  /// one of them is older than a second.
  std::optional<BodyReadings> read(std::int64_t now_ns) override;
  [[nodiscard]] std::string fault() const override { return fault_; }

 private:
  struct Range {
    float range_m = 0.0F;
    std::int64_t taken_ns = 0;
  };
  double units_per_m_;
  std::vector<std::optional<Range>> ranges_;  // of each number up to the largest one
  std::string fault_ = "the base has not reported its sonars yet";
};

}  // namespace topogeo::devices
