#include "settings_check.hpp"

#include <sstream>
#include <stdexcept>

namespace topogeo::navigation {

void check_range(const char* section, const char* field, double value, double low, double high) {
  if (value >= low && value <= high) return;
  std::ostringstream text;
  text << section << ": " << field << " is " << value << ", allowed are " << low << " to " << high;
  throw std::invalid_argument(text.str());
}

}  // namespace topogeo::navigation
