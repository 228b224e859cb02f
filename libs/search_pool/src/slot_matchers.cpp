#include "topogeo/search_pool/slot_matchers.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "topogeo/matching/place_field.hpp"
#include "topogeo/search_pool/map_cache.hpp"

namespace topogeo::search_pool {

namespace {

/// Grids on the most recently used reference maps of a matcher: Matcher::kKeptReferences of them.
constexpr std::size_t kGrid_bytes = std::size_t{3} << 20U;
/// View of the laser by direction, per map.
constexpr std::size_t kProfile_bytes = 6000;
/// A point as a surface point with its normal and as a coarse point, in addition to the point
/// itself.
constexpr std::size_t kBytesPerPoint = 40;

std::size_t feature_bytes(const topomap::LocalMap& map) {
  return kProfile_bytes + bytes_of(map) + map.points.size() * kBytesPerPoint;
}

}  // namespace

localization::MatchResult SlotMatchers::solve(const ReadyJob& job) {
  Kept& kept = of(job.job.client_id);
  const localization::MatchTask& task = job.job.task;
  if (task.places) {
    if (!kept.matcher.has_field(task.places->field_hash)) add_field(kept, job);
    localization::MatchResult result = kept.matcher.solve(task);
    make_room();
    return result;
  }
  if (!kept.matcher.has_map(task.reference_map_id, task.reference_hash)) {
    add_map(kept, job.reference);
  }
  if (!kept.matcher.has_map(task.query_map_id, task.query_hash)) {
    add_map(kept, job.query);
  }
  localization::MatchResult result = kept.matcher.solve(task);
  make_room();
  return result;
}

std::size_t SlotMatchers::maps() const {
  std::size_t maps = 0;
  for (const Kept& kept : kept_) maps += kept.maps;
  return maps;
}

std::size_t SlotMatchers::bytes() const {
  std::size_t bytes = 0;
  for (const Kept& kept : kept_) bytes += kept.bytes;
  return bytes;
}

SlotMatchers::Kept& SlotMatchers::of(const std::string& client_id) {
  const auto found = std::find_if(kept_.begin(), kept_.end(),
                                  [&](const Kept& kept) { return kept.client_id == client_id; });
  if (found == kept_.end()) {
    kept_.push_front({client_id, {}, 0, kGrid_bytes, 0});
  } else {
    kept_.splice(kept_.begin(), kept_, found);
  }
  return kept_.front();
}

void SlotMatchers::add_map(Kept& kept, const MapPointer& map) {
  kept.matcher.add_map(*map);
  ++kept.maps;
  kept.bytes += feature_bytes(*map);
}

void SlotMatchers::add_field(Kept& kept, const ReadyJob& job) {
  auto field = std::make_shared<const localization::PlaceField>(job.pieces, *job.job.task.places);
  kept.bytes += field->bytes() - kept.field_bytes;
  kept.field_bytes = field->bytes();
  kept.matcher.add_field(std::move(field));
}

// A matcher cannot drop single maps. One that has grown too large is dropped as a whole:
// recomputing a map that is still needed takes less time than one search.
void SlotMatchers::make_room() {
  while (bytes() > capacity_bytes_ && kept_.size() > 1) kept_.pop_back();
  if (bytes() > std::max(capacity_bytes_, 2 * kGrid_bytes)) kept_.clear();
}

}  // namespace topogeo::search_pool
