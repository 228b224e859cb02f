#include "stop_input.hpp"

#include <memory>
#include <string>

#include "topogeo/service/conversions.hpp"

namespace topogeo::localizer {

bool add_stop(service::Service& service, const msg::LocalMap& message, bool finished,
              StopQueue& queue) {
  const std::string name =
      "local map " + std::to_string(message.id()) + " of " + message.robot_id().to_string();
  const StopQueue::Arrival arrival =
      queue.arrival({message.session(), message.id()}, message.content_hash());
  if (arrival == StopQueue::Arrival::kOtherRun) {
    service.status().fault("local map of another run", name);
  }
  if (arrival != StopQueue::Arrival::kNew) return false;
  if (finished) {
    service.status().fault("local map after the end", name);
    return false;
  }
  queue.add(std::make_shared<const topomap::LocalMap>(service::from_msg(message)));
  return true;
}

}  // namespace topogeo::localizer
