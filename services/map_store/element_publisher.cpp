#include "element_publisher.hpp"

#include <string>

namespace topogeo::map_store {

ElementPublisher::ElementPublisher(service::Service& service)
    : service_(service),
      updates_(service.robot_id()),
      elements_(service.advertise<msg::MapElement>()) {}

bool ElementPublisher::publish(const topomap::GlobalMap& map, std::int64_t stamp_ns) {
  const ElementUpdates::Update update = updates_.update_to(map, stamp_ns);
  for (const msg::MapElement& element : update.gone) {
    elements_.dispose(element);
    updates_.disposed(element);
  }
  bool all_sent = true;
  for (const msg::MapElement& element : update.changed) {
    if (elements_.write(element)) {
      updates_.sent(element);
    } else {
      service_.status().fault("map element not sent", std::to_string(element.id()));
      all_sent = false;
    }
  }
  messaging::StatusPublisher& status = service_.status();
  status.add_to_counter("map_updates");
  status.set_counter("map_elements_sent", static_cast<double>(updates_.count()));
  status.set_counter("map_nodes", static_cast<double>(map.nodes.size()));
  status.set_counter("map_branches", static_cast<double>(map.branches.size()));
  return all_sent;
}

}  // namespace topogeo::map_store
