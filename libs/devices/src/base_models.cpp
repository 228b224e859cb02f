#include "topogeo/devices/base_models.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>

#include "topogeo/devices/create_driver.hpp"
#include "topogeo/devices/kobuki_driver.hpp"
#include "topogeo/devices/pioneer_driver.hpp"
#include "topogeo/devices/roboteq_driver.hpp"
#include "topogeo/devices/rwi_driver.hpp"
#include "topogeo/devices/text_base_driver.hpp"
#include "topogeo/devices/vesc_driver.hpp"

namespace topogeo::devices {
namespace {

std::unique_ptr<BaseDriver> make_rwi(const BaseSettings& settings) {
  return std::make_unique<RwiDriver>(settings);
}

std::unique_ptr<BaseDriver> make_text(const BaseSettings& settings) {
  return std::make_unique<TextBaseDriver>(settings);
}

std::unique_ptr<BaseDriver> make_create(const BaseSettings& settings) {
  return std::make_unique<CreateDriver>(settings);
}

std::unique_ptr<BaseDriver> make_kobuki(const BaseSettings& settings) {
  return std::make_unique<KobukiDriver>(settings);
}

std::unique_ptr<BaseDriver> make_pioneer(const BaseSettings& settings) {
  return std::make_unique<PioneerDriver>(settings);
}

std::unique_ptr<BaseDriver> make_roboteq(const BaseSettings& settings) {
  return std::make_unique<RoboteqDriver>(settings);
}

std::unique_ptr<BaseDriver> make_vesc(const BaseSettings& settings) {
  return std::make_unique<VescDriver>(settings);
}

#define TOPOGEO_BASE(family, name, baud, battery_low_v, title) \
  BaseModel{#family, name, baud, battery_low_v, title, make_##family},
constexpr std::array kBaseModels{
#include "topogeo/devices/base_models.def"
};

}  // namespace

std::span<const BaseModel> base_models() {
  return kBaseModels;
}

const BaseModel& base_model(std::string_view name) {
  const auto* const model = std::ranges::find(kBaseModels, name, &BaseModel::name);
  if (model == kBaseModels.end()) {
    throw std::invalid_argument("base model '" + std::string(name) + "': not known");
  }
  return *model;
}

std::unique_ptr<BaseDriver> make_base_driver(const BaseSettings& settings) {
  const BaseModel& model = settings.model != nullptr ? *settings.model : kBaseModels.front();
  return model.make(settings);
}

}  // namespace topogeo::devices
