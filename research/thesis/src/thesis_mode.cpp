#include "topogeo/thesis/thesis_mode.hpp"

#include <memory>

#include "topogeo/slam/localizer_config.hpp"
#include "topogeo/thesis/thesis_slam.hpp"

namespace topogeo::localization {
namespace {

struct ThesisMode : AddedMode {
  ThesisConfig settings;

  [[nodiscard]] std::unique_ptr<AddedMode> copy() const override {
    return std::make_unique<ThesisMode>(*this);
  }
  void describe(support::ConfigSchema& schema) override {
    localization::describe(settings, schema);
  }
  [[nodiscard]] std::unique_ptr<Slam> make(const LocalizerConfig& config,
                                           MatchPool& pool) const override {
    return std::make_unique<ThesisSlam>(ThesisSlamConfig{config, settings}, pool);
  }
};

}  // namespace

void add_thesis_mode() {
  add_mode(std::make_unique<ThesisMode>());
}

ThesisSlamConfig thesis_config(const LocalizerConfig& config) {
  const auto* mode = dynamic_cast<const ThesisMode*>(config.added_mode.get());
  return {config, mode == nullptr ? ThesisConfig{} : mode->settings};
}

}  // namespace topogeo::localization
