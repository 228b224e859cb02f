// Resumes a starting localizer with the map of the map store.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "topogeo/service/store_client.hpp"
#include "topogeo/slam/stored_map.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::localizer {

/// The state from which the localizer continues.
struct ResumeFrom {
  std::shared_ptr<const localization::StoredMap>
      map;                       ///< null: the map begins with the stops below
  bool resumes_session = false;  ///< its last stop belongs to the current session
  std::vector<std::shared_ptr<const topomap::LocalMap>> stops;  ///< of that session, to be added
};

/// Waits for the map store and gets its map. Lives in the loop of its service.
class Resume {
 public:
  using Handler = std::function<void(ResumeFrom from)>;

  /// The stops of a session that makes up the whole map are added again from the first one, which
  /// gives the map of an undisturbed run to the bit: always when `exact`, otherwise while that
  /// takes no longer than a second or two. Calls `on_ready` once.
  Resume(service::Service& service, bool exact, Handler on_ready);

 private:
  void on_stored(const msg::StoredMap& stored);
  void get_map();
  void get_stops(std::uint32_t first);
  void on_map(const service::StoreClient::Answer& answer);
  void on_stops(const service::StoreClient::Answer& answer);
  /// Returns false, with a fault, when the store has no answer; everything is then requested again.
  bool usable(const service::StoreClient::Answer& answer);

  service::Service& service_;
  bool exact_;
  Handler on_ready_;
  std::optional<msg::StoredMap> stored_;
  ResumeFrom from_;
  service::StoreClient client_;
};

}  // namespace topogeo::localizer
