#include "topogeo/service/replay_rate.hpp"

#include <stdexcept>

namespace topogeo::service {

ReplayRate parse_rate(const std::string& text) {
  constexpr double kSlowest = 0.01;
  constexpr double kFastest = 1000.0;
  if (text == "lossless") return std::nullopt;
  if (text == "realtime") return 1.0;
  try {
    std::size_t used = 0;
    const double factor = std::stod(text, &used);
    if (used == text.size() && factor >= kSlowest && factor <= kFastest) return factor;
  } catch (const std::logic_error&) {  // reported below
  }
  throw std::invalid_argument("rate '" + text +
                              "': expected realtime, lossless or a factor from 0.01 to 1000");
}

}  // namespace topogeo::service
