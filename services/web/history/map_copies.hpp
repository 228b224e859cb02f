// Complete maps from the map store, fetched on demand and kept for a while: the current one and
// those of its snapshots.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "topogeo/service/service.hpp"
#include "topogeo/service/store_client.hpp"
#include "topogeo/storage/map_document.hpp"

#include "orders/background.hpp"

namespace topogeo::web {

/// Lives in the loop of its service.
class MapCopies {
 public:
  using Document = std::shared_ptr<const storage::MapDocument>;
  /// The map, or null and the reason.
  using Handler = std::function<void(const Document& map, const std::string& why)>;
  using Check = std::function<bool(const storage::MapDocument& map)>;
  static constexpr std::size_t kMostWaiting = 16;

  /// `on_shown`: called when a map store shows a finished map.
  MapCopies(service::Service& service, Background& background, std::function<void()> on_shown);
  ~MapCopies();
  MapCopies(const MapCopies&) = delete;
  MapCopies& operator=(const MapCopies&) = delete;

  /// `snapshot`: its name; empty: the current map. Uses a kept copy if it is `good`, as a snapshot
  /// always is.
  void get(const std::string& snapshot, const Check& good, Handler handler);
  /// The maps fetched so far may have changed.
  void forget() { kept_.clear(); }

 private:
  struct Wanted {
    std::string snapshot;
    Check good;
    Handler handler;
  };
  struct Kept {
    std::string snapshot;
    Document map;
    double used_s = 0.0;  // by the steady clock
  };
  [[nodiscard]] Document find(const std::string& snapshot, const Check& good);
  void fetch_next();
  void take(const std::string& snapshot, std::string bytes);
  /// Passes the map to all requests for this snapshot.
  void give(const std::string& snapshot, const Document& map, const std::string& why);
  void tick();

  service::Service& service_;
  Background& background_;
  service::StoreClient store_;
  std::deque<Wanted> waiting_;
  std::vector<Kept> kept_;
  bool fetching_ = false;
  std::uint64_t fetch_ = 0;  // number of the current fetch
  double fetching_since_s_ = 0.0;
  std::uint64_t timer_ = 0;
};

}  // namespace topogeo::web
