#include "topogeo/devices/laser_models.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>

#include "topogeo/devices/cola_driver.hpp"
#include "topogeo/devices/ldrobot_driver.hpp"
#include "topogeo/devices/lds_driver.hpp"
#include "topogeo/devices/pls_driver.hpp"
#include "topogeo/devices/rplidar_driver.hpp"
#include "topogeo/devices/safety_driver.hpp"
#include "topogeo/devices/scip_driver.hpp"
#include "topogeo/devices/ydlidar_driver.hpp"

namespace topogeo::devices {
namespace {

std::unique_ptr<LaserDriver> make_pls(const LaserModel& /*model*/, const LaserSettings& settings) {
  return std::make_unique<PlsDriver>(settings.pls);
}

std::unique_ptr<LaserDriver> make_ldrobot(const LaserModel& model, const LaserSettings& settings) {
  return std::make_unique<LdRobotDriver>(model, settings.turning);
}

/// The same packets of a laser that looks past its axis.
std::unique_ptr<LaserDriver> make_ldrobot_offset(const LaserModel& model,
                                                 const LaserSettings& settings) {
  return make_ldrobot(model, settings);
}

std::unique_ptr<LaserDriver> make_xv11(const LaserModel& model, const LaserSettings& settings) {
  return std::make_unique<LdsDriver>(model, settings.turning, settings.lds);
}

/// The same packets with more readings.
std::unique_ptr<LaserDriver> make_lds01(const LaserModel& model, const LaserSettings& settings) {
  return make_xv11(model, settings);
}

std::unique_ptr<LaserDriver> make_rplidar(const LaserModel& model, const LaserSettings& settings) {
  return std::make_unique<RpLidarDriver>(model, settings.turning, settings.rplidar);
}

/// The same protocol; these lasers have dense packets as their second mode.
std::unique_ptr<LaserDriver> make_rplidar_dense(const LaserModel& model,
                                                const LaserSettings& settings) {
  return make_rplidar(model, settings);
}

std::unique_ptr<LaserDriver> make_ydlidar(const LaserModel& model, const LaserSettings& settings) {
  return std::make_unique<YdLidarDriver>(model, settings.turning, settings.rplidar.motor);
}

/// The same packets of a laser that reads no requests.
std::unique_ptr<LaserDriver> make_ydlidar_one_way(const LaserModel& model,
                                                  const LaserSettings& settings) {
  return make_ydlidar(model, settings);
}

/// The same packets of a laser that measures the time of flight.
std::unique_ptr<LaserDriver> make_ydlidar_tof(const LaserModel& model,
                                              const LaserSettings& settings) {
  return make_ydlidar(model, settings);
}

std::unique_ptr<LaserDriver> make_scip(const LaserModel& model, const LaserSettings& settings) {
  return std::make_unique<ScipDriver>(model, settings.turning, settings.scip);
}

std::unique_ptr<LaserDriver> make_cola(const LaserModel& model, const LaserSettings& settings) {
  return std::make_unique<ColaDriver>(model, settings.turning, settings.cola);
}

std::unique_ptr<LaserDriver> make_sick_safety(const LaserModel& model,
                                              const LaserSettings& settings) {
  return std::make_unique<SafetyDriver>(model, settings.turning, settings.safety);
}

#define TOPOGEO_LASER(family, name, title, baud, parity, beams, view_deg, turns_hz, range_max_m, \
                      network_port)                                                              \
  LaserModel{#family,      name,         title,    LineSettings{baud, Parity::parity},           \
             beams,        view_deg,     turns_hz, range_max_m,                                  \
             network_port, make_##family},
constexpr std::array kLaserModels{
#include "topogeo/devices/laser_models.def"
};

}  // namespace

std::span<const LaserModel> laser_models() {
  return kLaserModels;
}

const LaserModel& laser_model(std::string_view name) {
  const auto* const model = std::ranges::find(kLaserModels, name, &LaserModel::name);
  if (model == kLaserModels.end()) {
    throw std::invalid_argument("laser model '" + std::string(name) + "': not known");
  }
  return *model;
}

bool sends_datagrams(const LaserModel& model) {
  return model.family == "sick_safety";
}

LineSettings line_of(const LaserModel& model, const TurningLaserSettings& settings) {
  return {settings.baud > 0 ? settings.baud : model.line.baud, model.line.parity};
}

std::unique_ptr<LaserDriver> make_laser_driver(const LaserSettings& settings) {
  const LaserModel& model = settings.model != nullptr ? *settings.model : kLaserModels.front();
  return model.make(model, settings);
}

}  // namespace topogeo::devices
