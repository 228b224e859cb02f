#include <string_view>

#include "topogeo/simulation/base_emulator.hpp"
#include "topogeo/simulation/create_emulator.hpp"
#include "topogeo/simulation/kobuki_emulator.hpp"
#include "topogeo/simulation/mcp_emulator.hpp"
#include "topogeo/simulation/pioneer_emulator.hpp"
#include "topogeo/simulation/roboteq_emulator.hpp"
#include "topogeo/simulation/text_base_emulator.hpp"
#include "topogeo/simulation/vesc_emulator.hpp"

namespace topogeo::simulation {
namespace {

/// The settings of a family for a line and a seed, otherwise the defaults.
template <class FamilySettings>
FamilySettings on_line(const BaseEmulatorSettings& settings) {
  FamilySettings family;
  family.line = {settings.baud, devices::Parity::kNone};
  family.seed = settings.seed;
  return family;
}

std::unique_ptr<BaseEmulator> emulate_rwi(const BaseEmulatorSettings& settings,
                                          std::int64_t now_ns) {
  return std::make_unique<McpEmulator>(on_line<McpEmulatorSettings>(settings), now_ns);
}

std::unique_ptr<BaseEmulator> emulate_text(const BaseEmulatorSettings& settings,
                                           std::int64_t now_ns) {
  constexpr std::uint32_t kFastLine = 38'400;
  constexpr std::int64_t kSlowReports_ns = 100'000'000;
  auto text = on_line<TextBaseEmulatorSettings>(settings);
  if (settings.baud < kFastLine) text.report_ns = kSlowReports_ns;
  return std::make_unique<TextBaseEmulator>(text, now_ns);
}

std::unique_ptr<BaseEmulator> emulate_create(const BaseEmulatorSettings& settings,
                                             std::int64_t now_ns) {
  return std::make_unique<CreateEmulator>(on_line<CreateEmulatorSettings>(settings), now_ns);
}

std::unique_ptr<BaseEmulator> emulate_kobuki(const BaseEmulatorSettings& settings,
                                             std::int64_t now_ns) {
  return std::make_unique<KobukiEmulator>(on_line<KobukiEmulatorSettings>(settings), now_ns);
}

std::unique_ptr<BaseEmulator> emulate_pioneer(const BaseEmulatorSettings& settings,
                                              std::int64_t now_ns) {
  return std::make_unique<PioneerEmulator>(on_line<PioneerEmulatorSettings>(settings), now_ns);
}

std::unique_ptr<BaseEmulator> emulate_roboteq(const BaseEmulatorSettings& settings,
                                              std::int64_t now_ns) {
  return std::make_unique<RoboteqEmulator>(on_line<RoboteqEmulatorSettings>(settings), now_ns);
}

std::unique_ptr<BaseEmulator> emulate_vesc(const BaseEmulatorSettings& settings,
                                           std::int64_t now_ns) {
  return std::make_unique<VescEmulator>(on_line<VescEmulatorSettings>(settings), now_ns);
}

using MakeBaseEmulator = std::unique_ptr<BaseEmulator> (*)(const BaseEmulatorSettings&,
                                                           std::int64_t);

#define TOPOGEO_BASE(family, name, baud, battery_low_v, title) emulate_##family,
constexpr MakeBaseEmulator kBaseEmulators[] = {
#include "topogeo/devices/base_models.def"
};

}  // namespace

std::unique_ptr<BaseEmulator> make_base_emulator(const BaseEmulatorSettings& settings,
                                                 std::int64_t now_ns) {
  const devices::BaseModel& model =
      settings.model != nullptr ? *settings.model : devices::base_models().front();
  return kBaseEmulators[&model - devices::base_models().data()](settings, now_ns);
}

}  // namespace topogeo::simulation
