// The matchers of one slot, with the features of the local maps that it has used.
#pragma once

#include <cstddef>
#include <list>
#include <string>

#include "topogeo/matching/matcher.hpp"
#include "topogeo/search_pool/match_job.hpp"

namespace topogeo::search_pool {

/// A matcher per client, because ids of maps are unique only within a client. Each slot computes
/// the features of the maps itself: slots share nothing while they search. Not thread-safe.
class SlotMatchers {
 public:
  /// Drops the least recently used matchers if all together exceed `capacity_bytes`, by estimate;
  /// if the one in use does so alone, it starts again empty.
  explicit SlotMatchers(std::size_t capacity_bytes) : capacity_bytes_(capacity_bytes) {}

  /// Throws what Matcher::solve throws for a task that cannot be solved.
  localization::MatchResult solve(const ReadyJob& job);

  /// Number of stored matchers; maps() is the number of local maps in all of them.
  [[nodiscard]] std::size_t size() const { return kept_.size(); }
  [[nodiscard]] std::size_t maps() const;
  [[nodiscard]] std::size_t bytes() const;

 private:
  struct Kept {
    std::string client_id;
    localization::Matcher matcher;
    std::size_t maps = 0;
    std::size_t bytes = 0;
    std::size_t field_bytes = 0;  // part of `bytes` for the whole map that places are searched in
  };

  Kept& of(const std::string& client_id);
  static void add_map(Kept& kept, const MapPointer& map);
  static void add_field(Kept& kept, const ReadyJob& job);
  void make_room();

  std::size_t capacity_bytes_;
  std::list<Kept> kept_;  // most recently used first
};

}  // namespace topogeo::search_pool
