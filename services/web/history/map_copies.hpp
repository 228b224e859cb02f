// Whole maps of the map store, fetched when they are wanted and kept for a while: the one of now
// and those of its snapshots.
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
  /// The map, or null and why there is none.
  using Handler = std::function<void(const Document& map, const std::string& why)>;
  using Check = std::function<bool(const storage::MapDocument& map)>;
  static constexpr std::size_t kMostWaiting = 16;

  /// `on_shown`: a map store shows a map that nothing is added to.
  MapCopies(service::Service& service, Background& background, std::function<void()> on_shown);
  ~MapCopies();
  MapCopies(const MapCopies&) = delete;
  MapCopies& operator=(const MapCopies&) = delete;

  /// `snapshot`: its name; empty: the map of now. A copy that is kept is taken where it is `good`,
  /// which a snapshot always is.
  void get(const std::string& snapshot, const Check& good, Handler handler);
  /// Maps that were fetched before may be others now.
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
  /// To all who want this one.
  void give(const std::string& snapshot, const Document& map, const std::string& why);
  void tick();

  service::Service& service_;
  Background& background_;
  service::StoreClient store_;
  std::deque<Wanted> waiting_;
  std::vector<Kept> kept_;
  bool fetching_ = false;
  std::uint64_t fetch_ = 0;  // counts them
  double fetching_since_s_ = 0.0;
  std::uint64_t timer_ = 0;
};

}  // namespace topogeo::web
