#include "reproduce/worlds.hpp"

#include <algorithm>
#include <stdexcept>

#include "topogeo/support/config_schema.hpp"

namespace topogeo::reproduce {
namespace {

const WorldText* find_world(std::string_view name) {
  const std::vector<WorldText>& all = world_texts();
  const auto at = std::ranges::find(all, name, &WorldText::name);
  return at == all.end() ? nullptr : &*at;
}

}  // namespace

bool has_world(std::string_view name) {
  return find_world(name) != nullptr;
}

world::World world_named(std::string_view name) {
  const WorldText* found = find_world(name);
  if (found == nullptr) throw std::invalid_argument("no world " + std::string(name));
  return world::parse_world(std::string(found->text), std::string(name));
}

pipeline::Config thesis_preset() {
  pipeline::Config config;
  support::load_yaml_text(thesis_preset_text(), "thesis.config.yaml", pipeline::describe(config));
  config.local_mapper.tracker.odometry = config.localizer.odometry;
  return config;
}

}  // namespace topogeo::reproduce
