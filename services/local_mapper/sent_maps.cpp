#include "sent_maps.hpp"

namespace topogeo::local_mapper {

void SentMaps::set_stored(std::uint64_t session, std::uint32_t stops) {
  session_ = session;
  stops_ = stops;
  nothing_stored_ = false;
}

// A session before the one being stored now is stored completely.
bool SentMaps::is_stored(const topomap::StopId& stop) const {
  if (sent_.back().session != session_) return false;
  return stop.session != session_ || stop.number < stops_;
}

std::vector<topomap::StopId> SentMaps::take_old(bool readers_have_all) {
  std::vector<topomap::StopId> old;
  while (sent_.size() > limits_.stored) {
    const topomap::StopId& stop = sent_.front();
    const bool wanted = !is_stored(stop) && !(nothing_stored_ && readers_have_all);
    if (wanted && sent_.size() <= limits_.unstored) break;
    old.push_back(stop);
    sent_.pop_front();
  }
  return old;
}

}  // namespace topogeo::local_mapper
