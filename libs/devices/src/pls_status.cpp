#include "topogeo/devices/pls_status.hpp"

namespace topogeo::devices {
namespace {

LaserState laser_state(PlsState state) {
  switch (state) {
    case PlsState::kDetecting:
    case PlsState::kConfiguring:
      return LaserState::kStarting;
    case PlsState::kRunning:
      return LaserState::kRunning;
    case PlsState::kFailed:
      return LaserState::kFailed;
    case PlsState::kOffline:
      break;
  }
  return LaserState::kOffline;
}

std::string fault_of(const PlsStatus& status) {
  if (status.stuck) return "the laser repeats the same scan";
  if (status.health.implausible) return "the laser reports implausible measurements";
  if (status.health.severity >= PlsSeverity::kError) return "the laser reports an error";
  return {};
}

}  // namespace

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

LaserHealth laser_health(const PlsStatus& status) {
  LaserHealth health;
  health.state = laser_state(status.state);
  health.reason = status.reason;
  health.fault = fault_of(status);
  health.device = status.power_on_text;
  health.line = status.line;
  health.contaminated = status.health.polluted;
  health.implausible = status.health.implausible;
  health.error_level = static_cast<std::uint16_t>(status.health.severity);
  health.searches = status.counters.searches;
  const PlsCounters& counters = status.counters;
  health.drops = {{"bad checksum", counters.line.bad_crc},
                  {"implausible length", counters.line.implausible_length},
                  {"truncated telegram", counters.line.truncated},
                  {"noise bytes", counters.line.noise_bytes},
                  {"echoes", counters.line.echoes},
                  {"unexpected number of beams", counters.scan_drops.beam_count},
                  {"interlaced scan", counters.scan_drops.interlaced},
                  {"implausible scan", counters.scan_drops.implausible},
                  {"laser reports an error", counters.scan_drops.sensor_error},
                  {"stuck scan", counters.scan_drops.stuck},
                  {"scan while being set up", counters.unsolicited}};
  return health;
}

}  // namespace topogeo::devices
