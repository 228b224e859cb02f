// The matchers of one slot, with what they have made of the local maps that the slot was asked for.
#pragma once

#include <cstddef>
#include <list>
#include <string>

#include "topogeo/localization/matching/matcher.hpp"
#include "topogeo/search_pool/match_job.hpp"

namespace topogeo::search_pool {

/// A matcher for each client, as a client has one map of each id. Each slot makes the features of
/// the maps for itself: slots share nothing while they search. Not safe for several threads.
class SlotMatchers {
 public:
  /// The least recently used matchers are dropped when all together take more than
  /// `capacity_bytes`, by estimate; the one in use starts anew when it does so alone.
  explicit SlotMatchers(std::size_t capacity_bytes) : capacity_bytes_(capacity_bytes) {}

  /// Throws what Matcher::solve throws for a task that cannot be solved.
  localization::MatchResult solve(const ReadyJob& job);

  /// Matchers that are kept now and local maps that they know, all together.
  [[nodiscard]] std::size_t size() const { return kept_.size(); }
  [[nodiscard]] std::size_t maps() const;
  [[nodiscard]] std::size_t bytes() const;

 private:
  struct Kept {
    std::string client_id;
    localization::Matcher matcher;
    std::size_t maps = 0;
    std::size_t bytes = 0;
    std::size_t field_bytes = 0;  // of them, of the whole map that places are searched for in
  };

  Kept& of(const std::string& client_id);
  static void add_map(Kept& kept, const MapPointer& map);
  static void add_field(Kept& kept, const ReadyJob& job);
  void make_room();

  std::size_t capacity_bytes_;
  std::list<Kept> kept_;  // most recently used first
};

}  // namespace topogeo::search_pool
