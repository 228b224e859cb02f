#include "topogeo/devices/pls_status.hpp"

namespace topogeo::devices {

const char* to_string(PlsState state) {
  switch (state) {
    case PlsState::kOffline:
      return "offline";
    case PlsState::kDetecting:
      return "detecting";
    case PlsState::kConfiguring:
      return "configuring";
    case PlsState::kRunning:
      return "running";
    case PlsState::kFailed:
      return "failed";
  }
  return "unknown";
}

}  // namespace topogeo::devices
