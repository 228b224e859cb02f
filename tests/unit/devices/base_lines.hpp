// The line settings for tests of the base's driver.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include <gtest/gtest.h>

#include "base_on_line.hpp"

namespace topogeo::devices {

struct Way {
  BaseDialect dialect;
  std::uint32_t baud;
};
inline std::string name_of(const testing::TestParamInfo<Way>& info) {
  return (info.param.dialect == BaseDialect::kAscii ? "Ascii" : "Binary") +
         std::to_string(info.param.baud);
}
inline BaseSettings settings_of(const Way& way) {
  BaseSettings settings;
  settings.dialect = way.dialect;
  settings.line.baud = way.baud;
  return settings;
}

class BaseOnAnyLine : public testing::TestWithParam<Way> {
 protected:
  BaseSettings settings() const { return settings_of(GetParam()); }
  double period_s() const { return 1e-9 * static_cast<double>(period_ns()); }
  std::int64_t period_ns() const { return ticks_ns(report_period_ticks(settings())); }
};

inline constexpr std::array kWays{Way{BaseDialect::kAscii, 9600}, Way{BaseDialect::kAscii, 38400},
                                  Way{BaseDialect::kBinary, 9600},
                                  Way{BaseDialect::kBinary, 38400}};

}  // namespace topogeo::devices
