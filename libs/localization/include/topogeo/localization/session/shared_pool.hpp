// One pool for several maps: each numbers its stops and its tasks by itself.
//
// In the pool a stop has one number for good, by the session and the number that it has there. A
// map that takes another in, or a robot that is followed in it, needs no second copy of a stop.
#pragma once

#include <cstdint>
#include <map>
#include <memory>

#include "topogeo/localization/matching/match.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::localization {

class SharedPool {
 public:
  /// The pool must outlive this, and this all of its views. Nobody else uses it.
  explicit SharedPool(MatchPool& pool) : pool_(pool) {}

  /// A pool for one map.
  [[nodiscard]] std::unique_ptr<MatchPool> view();

 private:
  class View;
  struct Known {
    std::uint32_t id = 0;  // in the pool
    std::uint64_t hash = 0;
  };
  Known add(const topomap::LocalMap& map);

  MatchPool& pool_;
  std::map<topomap::StopId, Known> known_;
  std::uint64_t next_task_ = 0;
  std::shared_ptr<const PlaceField> field_;  // that the pool knows, of one of the maps
};

}  // namespace topogeo::localization
