#include "topogeo/service/map_replacement.hpp"

#include <memory>
#include <set>
#include <utility>

#include "topogeo/msg/store.h"
#include "topogeo/support/log.hpp"

namespace topogeo::service {

void when_map_is_replaced(Service& service, std::function<void()> on_replaced) {
  // A disposal carries no fields, only its instance.
  const auto own = std::make_shared<std::set<messaging::Handle>>();
  service.subscribe<msg::StoredMap>(
      [own](const msg::StoredMap&, const messaging::SampleInfo& info) {
        own->insert(info.instance);
      },
      {.team = true, .of_map = true},
      [own, on_replaced = std::move(on_replaced)](const messaging::SampleInfo& info) {
        if (info.state != messaging::InstanceState::kDisposed) return;
        if (own->erase(info.instance) > 0) on_replaced();
      });
}

bool run_with_one_map(Service& service) {
  bool replaced = false;
  when_map_is_replaced(service, [&] {
    replaced = true;
    service.loop().stop();
  });
  service.run();
  if (!replaced || Service::stopping()) return false;
  spdlog::info("the map was replaced: restarting with the new map");
  return true;
}

}  // namespace topogeo::service
