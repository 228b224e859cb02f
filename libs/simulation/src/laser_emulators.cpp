#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>

#include "topogeo/simulation/cola_emulator.hpp"
#include "topogeo/simulation/laser_emulator.hpp"
#include "topogeo/simulation/ldrobot_emulator.hpp"
#include "topogeo/simulation/lds_emulator.hpp"
#include "topogeo/simulation/pls_emulator.hpp"
#include "topogeo/simulation/rplidar_emulator.hpp"
#include "topogeo/simulation/safety_emulator.hpp"
#include "topogeo/simulation/scip_emulator.hpp"
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
  pls.rate_in_any_mode = true;
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

/// Numbers of the models, as the maker's SDK has them.
constexpr std::pair<std::string_view, std::uint8_t> kRpNumbers[] = {
    {"rplidar_a1", 0x18}, {"rplidar_a2", 0x28}, {"rplidar_a3", 0x31},
    {"rplidar_s1", 0x61}, {"rplidar_s2", 0x71}, {"rplidar_c1", 0x41}};

std::unique_ptr<LaserEmulator> emulate_rplidar(const LaserEmulatorSettings& settings,
                                               const devices::LaserModel& model,
                                               LaserEmulator::Ranges ranges, std::int64_t now_ns) {
  RpLidarEmulatorSettings rplidar;
  rplidar.line = model.line;
  rplidar.turns_hz = model.turns_hz;
  rplidar.samples_hz = model.turns_hz * static_cast<double>(model.beams);
  rplidar.range_max_m = model.range_max_m;
  for (const auto& [name, number] : kRpNumbers) {
    if (model.name == name) rplidar.model = number;
  }
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

std::unique_ptr<LaserEmulator> emulate_scip(const LaserEmulatorSettings& settings,
                                            const devices::LaserModel& model,
                                            LaserEmulator::Ranges ranges, std::int64_t now_ns) {
  constexpr double kSecondsPerMinute = 60.0;
  constexpr double kMmPerM = 1000.0;
  ScipEmulatorSettings scip;
  scip.line = model.line;
  if (model.name == "urg_04lx") scip.sweep = {"", 20, 0, 1024, 44, 725, 384, 0};
  scip.sweep.model = model.title;
  scip.sweep.range_max_mm = static_cast<unsigned>(std::lround(kMmPerM * model.range_max_m));
  scip.sweep.rpm = static_cast<unsigned>(std::lround(kSecondsPerMinute * model.turns_hz));
  scip.seed = settings.seed;
  return std::make_unique<ScipEmulator>(scip, std::move(ranges), now_ns);
}

std::unique_ptr<LaserEmulator> emulate_cola(const LaserEmulatorSettings& settings,
                                            const devices::LaserModel& model,
                                            LaserEmulator::Ranges ranges, std::int64_t now_ns) {
  constexpr double kAhead_deg = 90.0;
  ColaEmulatorSettings cola;
  cola.line = model.line;
  // Newer lasers speak CoLa B unless they are told otherwise.
  if (model.name == "sick_tim7xx" || model.name == "sick_lrs4xxx")
    cola.dialect = devices::ColaDialect::kBinary;
  cola.name = model.title;
  cola.beams = model.beams;
  constexpr double kDegree = 180.0 / std::numbers::pi;
  const BeamPattern beams = beams_of(model);
  cola.step_deg = kDegree * beams.angle_step_rad;
  cola.first_deg = kAhead_deg + kDegree * beams.angle_min_rad;
  cola.turns_hz = model.turns_hz;
  cola.range_max_m = model.range_max_m;
  cola.seed = settings.seed;
  return std::make_unique<ColaEmulator>(cola, std::move(ranges), now_ns);
}

std::unique_ptr<LaserEmulator> emulate_sick_safety(const LaserEmulatorSettings& settings,
                                                   const devices::LaserModel& model,
                                                   LaserEmulator::Ranges ranges,
                                                   std::int64_t now_ns) {
  constexpr double kAhead_deg = 90.0;
  SafetyEmulatorSettings safety;
  safety.line = model.line;
  safety.beams = model.beams;
  safety.view_deg = model.view_deg;
  safety.first_deg = kAhead_deg - 0.5 * model.view_deg;
  safety.turns_hz = model.turns_hz;
  safety.range_max_m = model.range_max_m;
  safety.protective_field_m = settings.protective_field_m;
  safety.warning_field_m = settings.warning_field_m;
  safety.seed = settings.seed;
  return std::make_unique<SafetyEmulator>(safety, std::move(ranges), now_ns);
}

struct EmulatorRow {
  std::string_view name;
  MakeEmulator make;
};

#define TOPOGEO_LASER(family, name, title, baud, parity, beams, view_deg, turns_hz, range_max_m, \
                      network_port)                                                              \
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
