// One way to refuse a setting that is out of range.
#pragma once

namespace topogeo::navigation {

/// Throws std::invalid_argument "SECTION: FIELD is VALUE, allowed are LOW to HIGH" unless the value
/// lies within, both ends included.
void check_range(const char* section, const char* field, double value, double low, double high);

}  // namespace topogeo::navigation
