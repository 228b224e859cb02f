#include "topogeo/search_pool/map_cache.hpp"

#include <utility>

namespace topogeo::search_pool {

namespace {

template <class T>
std::size_t bytes_of_vector(const std::vector<T>& vector) {
  return vector.capacity() * sizeof(T);
}

}  // namespace

std::size_t bytes_of(const topomap::LocalMap& map) {
  std::size_t bytes = sizeof(topomap::LocalMap) + bytes_of_vector(map.points) +
                      bytes_of_vector(map.nodes) + bytes_of_vector(map.branches) +
                      bytes_of_vector(map.track);
  for (const topomap::LocalNode& node : map.nodes) bytes += bytes_of_vector(node.base_groups);
  for (const topomap::LocalBranch& branch : map.branches) bytes += bytes_of_vector(branch.points);
  return bytes;
}

void MapCache::add(std::uint64_t hash, MapPointer map) {
  if (find(hash)) return;
  const std::size_t bytes = bytes_of(*map);
  used_.push_front({hash, std::move(map), bytes});
  maps_[hash] = used_.begin();
  bytes_ += bytes;
  while (bytes_ > capacity_bytes_ && used_.size() > 1) {
    bytes_ -= used_.back().bytes;
    maps_.erase(used_.back().hash);
    used_.pop_back();
    ++dropped_;
  }
}

MapPointer MapCache::find(std::uint64_t hash) {
  const auto found = maps_.find(hash);
  if (found == maps_.end()) return nullptr;
  used_.splice(used_.begin(), used_, found->second);
  return found->second->map;
}

}  // namespace topogeo::search_pool
