#include <numbers>
#include <string_view>
#include <utility>

#include "topogeo/simulation/laser_emulator.hpp"
#include "topogeo/simulation/ldrobot_emulator.hpp"
#include "topogeo/simulation/lds_emulator.hpp"
#include "topogeo/simulation/pls_emulator.hpp"
#include "topogeo/simulation/rplidar_emulator.hpp"
#include "topogeo/simulation/ydlidar_emulator.hpp"

namespace topogeo::simulation {
namespace {

using MakeEmulator = std::unique_ptr<LaserEmulator> (*)(const LaserEmulatorSettings&,
                                                        const devices::LaserModel&,
                                                        LaserEmulator::Ranges, std::int64_t);

std::unique_ptr<LaserEmulator> emulate_pls(const LaserEmulatorSettings& settings,
                                           const devices::LaserModel& model,
                                           LaserEmulator::Ranges ranges, std::int64_t now_ns) {
  PlsEmulatorSettings pls;
  pls.power_on.parity = model.line.parity;
  pls.protective_field_m = settings.protective_field_m;
  pls.warning_field_m = settings.warning_field_m;
  pls.seed = settings.seed;
  return std::make_unique<PlsEmulator>(
      pls,
      [ranges = std::move(ranges), beams = beams_of(model)](std::int64_t at_ns) {
        return ranges(beams, at_ns);
      },
      now_ns);
}

std::unique_ptr<LaserEmulator> emulate_ldrobot(const LaserEmulatorSettings& settings,
                                               const devices::LaserModel& model,
                                               LaserEmulator::Ranges ranges, std::int64_t now_ns) {
  LdRobotEmulatorSettings ldrobot;
  ldrobot.line = model.line;
  ldrobot.turns_hz = model.turns_hz;
  ldrobot.samples_hz = model.turns_hz * static_cast<double>(model.beams);
  ldrobot.range_max_m = model.range_max_m;
  ldrobot.beside_axis = model.family == "ldrobot_offset";
  ldrobot.seed = settings.seed;
  return std::make_unique<LdRobotEmulator>(ldrobot, std::move(ranges), now_ns);
}

std::unique_ptr<LaserEmulator> emulate_ldrobot_offset(const LaserEmulatorSettings& settings,
                                                      const devices::LaserModel& model,
                                                      LaserEmulator::Ranges ranges,
                                                      std::int64_t now_ns) {
  return emulate_ldrobot(settings, model, std::move(ranges), now_ns);
}

std::unique_ptr<LaserEmulator> emulate_lds(const devices::LdsFormat& format, bool waits_for_letter,
                                           const LaserEmulatorSettings& settings,
                                           const devices::LaserModel& model,
                                           LaserEmulator::Ranges ranges, std::int64_t now_ns) {
  LdsEmulatorSettings lds;
  lds.format = format;
  lds.line = model.line;
  lds.waits_for_letter = waits_for_letter;
  lds.turns_hz = model.turns_hz;
  lds.range_max_m = model.range_max_m;
  lds.seed = settings.seed;
  return std::make_unique<LdsEmulator>(lds, std::move(ranges), now_ns);
}

std::unique_ptr<LaserEmulator> emulate_xv11(const LaserEmulatorSettings& settings,
                                            const devices::LaserModel& model,
                                            LaserEmulator::Ranges ranges, std::int64_t now_ns) {
  return emulate_lds(devices::kXv11, false, settings, model, std::move(ranges), now_ns);
}

std::unique_ptr<LaserEmulator> emulate_lds01(const LaserEmulatorSettings& settings,
                                             const devices::LaserModel& model,
                                             LaserEmulator::Ranges ranges, std::int64_t now_ns) {
  return emulate_lds(devices::kLds01, true, settings, model, std::move(ranges), now_ns);
}

std::unique_ptr<LaserEmulator> emulate_rplidar(const LaserEmulatorSettings& settings,
                                               const devices::LaserModel& model,
                                               LaserEmulator::Ranges ranges, std::int64_t now_ns) {
  constexpr std::uint8_t kOfSpeedRequests = 0x61;
  RpLidarEmulatorSettings rplidar;
  rplidar.line = model.line;
  rplidar.turns_hz = model.turns_hz;
  rplidar.samples_hz = model.turns_hz * static_cast<double>(model.beams);
  rplidar.range_max_m = model.range_max_m;
  if (model.line.baud > 115'200) rplidar.model = kOfSpeedRequests;
  rplidar.seed = settings.seed;
  return std::make_unique<RpLidarEmulator>(rplidar, std::move(ranges), now_ns);
}

std::unique_ptr<LaserEmulator> emulate_rplidar_dense(const LaserEmulatorSettings& settings,
                                                     const devices::LaserModel& model,
                                                     LaserEmulator::Ranges ranges,
                                                     std::int64_t now_ns) {
  return emulate_rplidar(settings, model, std::move(ranges), now_ns);
}

std::unique_ptr<LaserEmulator> emulate_ydlidar(const LaserEmulatorSettings& settings,
                                               const devices::LaserModel& model,
                                               LaserEmulator::Ranges ranges, std::int64_t now_ns) {
  YdLidarEmulatorSettings ydlidar;
  ydlidar.line = model.line;
  ydlidar.asked = model.family != "ydlidar_one_way";
  ydlidar.triangulates = model.family != "ydlidar_tof";
  ydlidar.reports_frequency = ydlidar.asked;
  ydlidar.turns_hz = model.turns_hz;
  ydlidar.samples_hz = model.turns_hz * static_cast<double>(model.beams);
  ydlidar.range_max_m = model.range_max_m;
  ydlidar.seed = settings.seed;
  return std::make_unique<YdLidarEmulator>(ydlidar, std::move(ranges), now_ns);
}

std::unique_ptr<LaserEmulator> emulate_ydlidar_one_way(const LaserEmulatorSettings& settings,
                                                       const devices::LaserModel& model,
                                                       LaserEmulator::Ranges ranges,
                                                       std::int64_t now_ns) {
  return emulate_ydlidar(settings, model, std::move(ranges), now_ns);
}

std::unique_ptr<LaserEmulator> emulate_ydlidar_tof(const LaserEmulatorSettings& settings,
                                                   const devices::LaserModel& model,
                                                   LaserEmulator::Ranges ranges,
                                                   std::int64_t now_ns) {
  return emulate_ydlidar(settings, model, std::move(ranges), now_ns);
}

struct EmulatorRow {
  std::string_view name;
  MakeEmulator make;
};

#define TOPOGEO_LASER(family, name, title, baud, parity, beams, view_deg, turns_hz, range_max_m) \
  EmulatorRow{name, emulate_##family},
constexpr EmulatorRow kEmulators[] = {
#include "topogeo/devices/laser_models.def"
};

}  // namespace

std::unique_ptr<LaserEmulator> make_laser_emulator(const LaserEmulatorSettings& settings,
                                                   LaserEmulator::Ranges ranges,
                                                   std::int64_t now_ns) {
  const devices::LaserModel& model =
      settings.model != nullptr ? *settings.model : devices::laser_models().front();
  const auto row = static_cast<std::size_t>(&model - devices::laser_models().data());
  return kEmulators[row].make(settings, model, std::move(ranges), now_ns);
}

BeamPattern beams_of(const devices::LaserModel& model) {
  constexpr double kTurn_deg = 360.0;
  const bool turns = model.view_deg >= kTurn_deg;
  const double gaps = static_cast<double>(turns ? model.beams : model.beams - 1);
  BeamPattern beams;
  beams.count = model.beams;
  beams.angle_step_rad = std::numbers::pi * (model.view_deg / 180.0) / gaps;
  beams.angle_min_rad = -std::numbers::pi * (model.view_deg / kTurn_deg);
  if (turns) beams.angle_min_rad += 0.5 * beams.angle_step_rad;
  return beams;
}

}  // namespace topogeo::simulation
