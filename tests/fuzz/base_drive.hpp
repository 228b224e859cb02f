// The line of a base that receives any bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "topogeo/devices/base_models.hpp"

namespace topogeo::fuzz {

/// Passes `bytes` as received from a base through the driver of its model, which is commanded to
/// drive, read by read. `check_orders` gets the orders of each. Returns the number of odometry
/// reports that the driver makes of them. Throws BrokenPromise.
std::size_t drive_base(
    const devices::BaseSettings& settings, std::span<const std::uint8_t> bytes,
    const std::function<void(const std::vector<devices::LineOrder>& orders)>& check_orders);

}  // namespace topogeo::fuzz
