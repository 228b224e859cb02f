#include "profile_names.hpp"

#include <array>
#include <cstddef>
#include <string_view>
#include <utility>

namespace topogeo::messaging {

namespace {

#if TOPOGEO_FAST_DDS == 2
constexpr std::array<std::pair<std::string_view, std::string_view>, 0> kNames{};
#else
constexpr std::array<std::pair<std::string_view, std::string_view>, 4> kNames{{
    {"heartbeatPeriod>", "heartbeat_period>"},
    {"heartbeatResponseDelay>", "heartbeat_response_delay>"},
    {"nackResponseDelay>", "nack_response_delay>"},
    {"nackSupressionDuration>", "nack_supression_duration>"},
}};
#endif

}  // namespace

std::string with_names_of_library(std::string text) {
  for (const auto& [old, now] : kNames) {
    for (std::size_t at = text.find(old); at != std::string::npos; at = text.find(old, at)) {
      text.replace(at, old.size(), now);
    }
  }
  return text;
}

}  // namespace topogeo::messaging
