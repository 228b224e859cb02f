// Where a localizer of several robots goes on: with their map, and with the stops of the session of
// each that are not in it.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "topogeo/localization/mapping/stored_map.hpp"
#include "topogeo/service/store_client.hpp"
#include "topogeo/storage/map_document.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::localizer {

struct SharedResumeFrom {
  std::shared_ptr<const localization::StoredMap> map;  ///< null: there is none yet
  /// Of the sessions that are on, to be added again, in the order in which they were made.
  std::vector<std::shared_ptr<const topomap::LocalMap>> stops;
  std::vector<storage::RefusedMerge> refused_merges;
};

/// Waits for the map store and gets from it what it has. Lives in the loop of its service.
class SharedResume {
 public:
  using Handler = std::function<void(SharedResumeFrom from)>;

  /// Calls `on_ready` once.
  SharedResume(service::Service& service, Handler on_ready);

 private:
  void on_stored(const msg::StoredMap& stored);
  void on_map(const service::StoreClient::Answer& answer);
  void get_stops();
  void on_stops(const service::StoreClient::Answer& answer);
  /// False, and a fault, when the store has no answer; then all is asked for again.
  bool usable(const service::StoreClient::Answer& answer);

  service::Service& service_;
  Handler on_ready_;
  std::map<std::string, msg::StoredMap> stored_;  // by robot
  bool begun_ = false;                            // all of them are here
  std::vector<msg::StoredMap> sessions_;          // whose stops are to be asked for
  SharedResumeFrom from_;
  service::StoreClient client_;
};

}  // namespace topogeo::localizer
