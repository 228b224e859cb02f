#include "topogeo/devices/base_status.hpp"

#include <array>
#include <cstddef>

namespace topogeo::devices {
namespace {

struct StateText {
  std::string_view name;
  std::string_view reason;
};

// Same order as BaseState.
constexpr std::array<StateText, 10> kStateTexts{{
    {"ready", ""},
    {"moving", ""},
    {"offline", "no connection to the drive unit"},
    {"starting", "the drive unit is being set up"},
    {"emergency stop",
     "the drive unit did not move as commanded: emergency stop or blocked wheels; it reports "
     "neither, so a person must release it"},
    {"halted", "held; release it to drive"},
    {"watchdog expired", "the drive unit stopped: it received no command for too long"},
    {"bumped", "a bumper was pressed"},
    {"joystick", "the drive unit moves without a command"},
    {"motors off", "the motors are limp"},
}};

}  // namespace

std::string_view base_state_name(BaseState state) {
  return kStateTexts.at(static_cast<std::size_t>(state)).name;
}

std::string_view base_state_reason(BaseState state) {
  return kStateTexts.at(static_cast<std::size_t>(state)).reason;
}

}  // namespace topogeo::devices
