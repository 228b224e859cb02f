// Refuses a value that is out of range. Settings declare their ranges themselves; this is for all
// other input: poses, readings, grids.
#pragma once

#include <string_view>

namespace topogeo::support {

/// Throws std::invalid_argument "WHAT is VALUE, expected LOW to HIGH UNIT" unless the value is a
/// number within the range, both ends included. Without a unit the text ends after HIGH.
void check_range(std::string_view what, double value, double low, double high,
                 std::string_view unit = {});

}  // namespace topogeo::support
