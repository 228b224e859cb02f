// Local maps that came before a localizer did and that their sender does not keep any more: they
// are taken from the map store, or left out where the rest can do without them.
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
  /// Keeps a reference to `queue`; `on_change` is called when it can go on. `ask`: the map store
  /// has them; a robot that is only to be found in a map needs no stops of before.
  MissingStops(service::Service& service, StopQueue& queue, bool ask,
               std::function<void()> on_change);

  /// Whether the queue waits for what does not come. To be called some times in a second.
  void check();

 private:
  void on_answer(const service::StoreClient::Answer& answer);
  /// Begins a session later than with its first stop, or reports that one that is on cannot go on.
  void skip();

  service::Service& service_;
  StopQueue& queue_;
  bool ask_;
  std::function<void()> on_change_;
  std::optional<service::StoreClient> store_;  // once it is needed
  std::optional<topomap::StopId> missing_;     // by the last check
  bool asking_ = false;
};

}  // namespace topogeo::localizer
