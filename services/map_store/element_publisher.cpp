#include "element_publisher.hpp"

#include <string>

namespace topogeo::map_store {

ElementPublisher::ElementPublisher(service::Service& service)
    : service_(service),
      updates_(service.robot_id()),
      elements_(service.advertise<msg::MapElement>()) {}

bool ElementPublisher::send(msg::MapElement& element) {
  updates_.number(element);
  if (!elements_.write(element)) {
    service_.status().fault("map element not sent", std::to_string(element.id()));
    return false;
  }
  updates_.sent(element);
  return true;
}

bool ElementPublisher::publish(const topomap::GlobalMap& map, std::uint64_t map_id,
                               std::int64_t stamp_ns) {
  ElementUpdates::Update update = updates_.update_to(map, map_id, stamp_ns);
  for (const msg::MapElement& element : update.gone) {
    elements_.dispose(element);
    updates_.disposed(element);
  }
  bool all_sent = true;
  for (msg::MapElement& element : update.changed) {
    // A summary is of no use without the elements it counts.
    if (element.kind() == msg::kElementSummary && !all_sent) break;
    all_sent &= send(element);
  }
  messaging::StatusPublisher& status = service_.status();
  status.add_to_counter("map_updates");
  status.set_counter("map_elements_sent", static_cast<double>(updates_.count()));
  status.set_counter("map_nodes", static_cast<double>(map.nodes.size()));
  status.set_counter("map_branches", static_cast<double>(map.branches.size()));
  return all_sent;
}

}  // namespace topogeo::map_store
