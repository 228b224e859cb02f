// One pool shared by several maps, each with its own numbers of stops and tasks.
//
// In the pool a stop has one permanent number, derived from its session and its number there. A map
// that merges another, or follows a robot, needs no second copy of a stop.
#pragma once

#include <cstdint>
#include <map>
#include <memory>

#include "topogeo/matching/match.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::localization {

class SharedPool {
 public:
  /// The pool must outlive this, and this must outlive its views. The pool must have no other user.
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
  std::shared_ptr<const PlaceField> field_;  // the field that the pool knows, of one of the maps
};

}  // namespace topogeo::localization
