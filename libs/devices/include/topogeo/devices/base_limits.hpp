// Checks of commands and limits of any base.
#pragma once

#include "topogeo/devices/base_settings.hpp"

namespace topogeo::devices {

/// Throws std::invalid_argument for a command that is not finite.
void require_finite(const char* name, double value);
/// `limits`, but nowhere above `most`. Throws std::invalid_argument unless all are finite and > 0.
[[nodiscard]] BaseLimits within(const BaseLimits& limits, const BaseLimits& most);
/// The part of a finite velocity that is within the speeds of `limits` (> 0), on the same arc: a
/// guard has judged that arc, and another one may lead into an obstacle.
[[nodiscard]] BaseVelocity within(const BaseVelocity& velocity, const BaseLimits& limits);

}  // namespace topogeo::devices
