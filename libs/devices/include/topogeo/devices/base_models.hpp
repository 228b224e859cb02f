// The bases that have a driver: one row each in base_models.def.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "topogeo/devices/base_driver.hpp"
#include "topogeo/devices/base_settings.hpp"

namespace topogeo::devices {

struct BaseModel {
  std::string_view family;     ///< bases with the same protocol
  std::string_view name;       ///< value of base.model
  std::uint32_t baud = 0;      ///< usual rate of the line
  double battery_low_v = 0.0;  ///< usual voltage of a low battery; 0: differs
  std::string_view title;      ///< maker and models
  std::unique_ptr<BaseDriver> (*make)(const BaseSettings& settings) = nullptr;
};

/// All models; the first is the default.
[[nodiscard]] std::span<const BaseModel> base_models();
/// Throws std::invalid_argument for a name that no model has.
[[nodiscard]] const BaseModel& base_model(std::string_view name);

/// Throws std::invalid_argument naming the first setting that is out of range.
[[nodiscard]] std::unique_ptr<BaseDriver> make_base_driver(const BaseSettings& settings);

}  // namespace topogeo::devices
