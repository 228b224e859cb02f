// Text without capital letters.
#pragma once

#include <string>
#include <string_view>

namespace topogeo::support {

/// The text with capital letters of ASCII as small ones; all else stays.
std::string lower_case(std::string_view text);

}  // namespace topogeo::support
