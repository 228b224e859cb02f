// Recovers local maps that were sent before the localizer started and that their sender no longer
// keeps: from the map store, or by leaving them out when the rest can do without them.
#pragma once

#include <functional>
#include <optional>

#include "topogeo/service/service.hpp"
#include "topogeo/service/store_client.hpp"
#include "topogeo/topomap/local_map.hpp"

#include "stop_queue.hpp"

namespace topogeo::localizer {

/// Lives in the loop of its service.
class MissingStops {
 public:
  /// Keeps a reference to `queue`; `on_change` is called when the queue can go on. `ask`: the map
  /// store has the maps; a robot that only localizes in a map does not need earlier stops.
  MissingStops(service::Service& service, StopQueue& queue, bool ask,
               std::function<void()> on_change);

  /// Checks whether the queue waits for a stop that will not arrive. Call it a few times a second.
  void check();

 private:
  void on_answer(const service::StoreClient::Answer& answer);
  /// Begins a session after its first stop, or reports that a running session cannot go on.
  void skip();

  service::Service& service_;
  StopQueue& queue_;
  bool ask_;
  std::function<void()> on_change_;
  std::optional<service::StoreClient> store_;  // created on first use
  std::optional<topomap::StopId> missing_;     // at the last check
  bool asking_ = false;
};

}  // namespace topogeo::localizer
