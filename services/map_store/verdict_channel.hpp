// Receives the decisions about loops and keeps them with the map, also those that arrive after its
// end.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <vector>

#include "topogeo/service/service.hpp"
#include "topogeo/storage/map_database.hpp"

#include "loop_verdicts.hpp"

namespace topogeo::map_store {

/// Lives in the loop of its service.
class VerdictChannel {
 public:
  /// False: they could not be stored now.
  using Keep = std::function<bool(const std::vector<storage::LoopVerdict>&)>;

  /// Begins with the stored ones. Throws like MapDatabase::loop_verdicts.
  VerdictChannel(service::Service& service, const storage::MapDatabase& database, Keep keep);

  /// Stores what has changed, not more than a twentieth of the time unless `now`. Verdicts about
  /// stops that are not stored yet wait for them.
  void store(bool now);

 private:
  using Clock = std::chrono::steady_clock;

  const storage::MapDatabase& database_;
  Keep keep_;
  LoopVerdicts verdicts_;
  std::uint64_t stored_ = 0;  // changes already stored
  Clock::time_point next_;
};

}  // namespace topogeo::map_store
