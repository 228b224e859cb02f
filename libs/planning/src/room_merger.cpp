#include "room_merger.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <queue>
#include <set>
#include <tuple>
#include <utility>

namespace topogeo::planning {
namespace {

struct Opening {
  double clearance_m = 0.0;
  bool is_door = false;
};

class RoomMerger {
 public:
  RoomMerger(const Basins& basins, const std::vector<bool>& doors, const RoomConfig& config,
             double cell_m)
      : config_(config),
        peak_m_(basins.peak_m),
        area_m2_(basins.peak_m.size(), 0.0),
        into_(basins.peak_m.size()),
        openings_(basins.peak_m.size()) {
    for (const std::uint32_t basin : basins.of_cell) {
      if (basin != kNoBasin) area_m2_[basin] += cell_m * cell_m;
    }
    for (std::uint32_t i = 0; i < into_.size(); ++i) into_[i] = i;
    for (std::size_t k = 0; k < basins.saddles.size(); ++k) {
      const Saddle& saddle = basins.saddles[k];
      openings_[saddle.a][saddle.b] =
          openings_[saddle.b][saddle.a] = {saddle.clearance_m, doors[k]};
      offer(saddle.a, saddle.b);
    }
  }

  std::vector<std::uint32_t> run() {
    while (!offers_.empty()) {
      const auto [ratio, minus_a, minus_b] = offers_.top();
      offers_.pop();
      const std::uint32_t a = 0xffffffff - minus_a;
      const std::uint32_t b = 0xffffffff - minus_b;
      if (into_[a] != a || into_[b] != b || !openings_[a].contains(b)) continue;
      if (ratio == ratio_of(a, b)) join(a, b);
    }
    join_nooks();
    std::vector<std::uint32_t> room(into_.size());
    for (std::uint32_t i = 0; i < room.size(); ++i) room[i] = room_of(i);
    return room;
  }

 private:
  [[nodiscard]] std::uint32_t room_of(std::uint32_t basin) const {
    while (into_[basin] != basin) basin = into_[basin];
    return basin;
  }

  [[nodiscard]] double ratio_of(std::uint32_t a, std::uint32_t b) const {
    return openings_[a].at(b).clearance_m / std::max(peak_m_[a], peak_m_[b]);
  }

  // Ties go to the first ones.
  void offer(std::uint32_t a, std::uint32_t b) {
    if (a > b) std::swap(a, b);
    const Opening& opening = openings_[a].at(b);
    const double least = opening.is_door ? config_.door_ratio : config_.narrowing_ratio;
    if (opening.clearance_m < least * std::min(peak_m_[a], peak_m_[b])) return;
    if (ratio_of(a, b) < config_.opening_ratio) return;
    offers_.emplace(ratio_of(a, b), 0xffffffff - a, 0xffffffff - b);
  }

  // Its neighbour with the widest opening; nothing without neighbours.
  [[nodiscard]] std::optional<std::uint32_t> opens_to(std::uint32_t room) const {
    const auto& openings = openings_[room];
    const auto widest = std::max_element(
        openings.begin(), openings.end(),
        [](const auto& a, const auto& b) { return a.second.clearance_m < b.second.clearance_m; });
    if (widest == openings.end()) return std::nullopt;
    return widest->first;
  }

  [[nodiscard]] bool is_nook(std::uint32_t room) const {
    const auto other = opens_to(room);
    if (!other || area_m2_[*other] < area_m2_[room]) return false;
    const double width_m = 2.0 * openings_[room].at(*other).clearance_m;
    return area_m2_[room] < config_.nook_depth * width_m * width_m;
  }

  void join_nooks() {
    std::set<std::pair<double, std::uint32_t>> nooks;
    for (std::uint32_t room = 0; room < into_.size(); ++room) {
      if (into_[room] == room && is_nook(room)) nooks.emplace(area_m2_[room], room);
    }
    while (!nooks.empty()) {
      const auto [area_m2, room] = *nooks.begin();
      nooks.erase(nooks.begin());
      if (into_[room] != room || area_m2 != area_m2_[room] || !is_nook(room)) continue;
      const std::uint32_t other = *opens_to(room);
      join(other, room);
      if (is_nook(other)) nooks.emplace(area_m2_[other], other);
    }
  }

  void join(std::uint32_t a, std::uint32_t b) {
    into_[b] = a;
    area_m2_[a] += area_m2_[b];
    peak_m_[a] = std::max(peak_m_[a], peak_m_[b]);
    openings_[a].erase(b);
    for (const auto& [other, opening] : openings_[b]) {
      openings_[other].erase(b);
      if (other == a) continue;
      Opening& kept = openings_[a][other];
      if (opening.clearance_m > kept.clearance_m) kept = opening;
      openings_[other][a] = kept;
    }
    openings_[b].clear();
    for (const auto& [other, opening] : openings_[a]) offer(a, other);
  }

  const RoomConfig& config_;
  std::vector<double> peak_m_;
  std::vector<double> area_m2_;
  std::vector<std::uint32_t> into_;
  std::vector<std::map<std::uint32_t, Opening>> openings_;
  std::priority_queue<std::tuple<double, std::uint32_t, std::uint32_t>> offers_;
};

}  // namespace

std::vector<std::uint32_t> rooms_of(const Basins& basins, const std::vector<bool>& doors,
                                    const RoomConfig& config, double cell_m) {
  return RoomMerger(basins, doors, config, cell_m).run();
}

}  // namespace topogeo::planning
