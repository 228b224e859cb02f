#include "topogeo/support/check_range.hpp"

#include <stdexcept>

#include "topogeo/support/format.hpp"

namespace topogeo::support {

void check_range(std::string_view what, double value, double low, double high,
                 std::string_view unit) {
  if (value >= low && value <= high) return;
  throw std::invalid_argument(fmt::format("{} is {:.9g}, expected {:.9g} to {:.9g}{}{}", what,
                                          value, low, high, unit.empty() ? "" : " ", unit));
}

}  // namespace topogeo::support
