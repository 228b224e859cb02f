// Resumes a localizer of several robots: with their map, and with the stops of each robot's session
// that are not in it.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "topogeo/service/store_client.hpp"
#include "topogeo/slam/stored_map.hpp"
#include "topogeo/storage/map_document.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::localizer {

struct SharedResumeFrom {
  std::shared_ptr<const localization::StoredMap> map;  ///< null: there is none yet
  /// Stops of the current sessions, to be added again in the order in which they were made.
  std::vector<std::shared_ptr<const topomap::LocalMap>> stops;
  std::vector<storage::RefusedMerge> refused_merges;
};

/// Waits for the map store and gets its map. Lives in the loop of its service.
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
  /// Returns false, with a fault, when the store has no answer; everything is then requested again.
  bool usable(const service::StoreClient::Answer& answer);

  service::Service& service_;
  Handler on_ready_;
  std::map<std::string, msg::StoredMap> stored_;  // by robot
  bool begun_ = false;                            // all messages have arrived
  std::vector<msg::StoredMap> sessions_;          // their stops are still to be requested
  SharedResumeFrom from_;
  service::StoreClient client_;
};

}  // namespace topogeo::localizer
