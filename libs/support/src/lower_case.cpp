#include "topogeo/support/lower_case.hpp"

#include <algorithm>
#include <cctype>

namespace topogeo::support {

std::string lower_case(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

}  // namespace topogeo::support
