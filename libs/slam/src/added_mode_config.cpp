#include "topogeo/slam/added_mode_config.hpp"

#include <utility>

namespace topogeo::localization {
namespace {

std::unique_ptr<AddedMode>& added_mode() {
  static std::unique_ptr<AddedMode> mode;
  return mode;
}

std::unique_ptr<AddedMode> copy_of(const std::unique_ptr<AddedMode>& mode) {
  return mode ? mode->copy() : nullptr;
}

}  // namespace

void add_mode(std::unique_ptr<AddedMode> defaults) {
  added_mode() = std::move(defaults);
}

AddedModeConfig::AddedModeConfig() : mode_(copy_of(added_mode())) {}
AddedModeConfig::AddedModeConfig(const AddedModeConfig& other) : mode_(copy_of(other.mode_)) {}

AddedModeConfig& AddedModeConfig::operator=(AddedModeConfig other) noexcept {
  mode_ = std::move(other.mode_);
  return *this;
}

}  // namespace topogeo::localization
