#include "zone_labels.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include "cell_neighbours.hpp"

namespace topogeo::planning {
namespace {

// Every cell gets the label of the nearest labelled one, by steps to the four sides.
void grow(const FreeSpace& space, ZoneLabels& labels) {
  std::vector<std::size_t> front;
  for (std::size_t i = 0; i < labels.of_cell.size(); ++i) {
    if (labels.of_cell[i] != kNoLabel) front.push_back(i);
  }
  std::vector<std::size_t> next;
  while (!front.empty()) {
    next.clear();
    for (const std::size_t i : front) {
      visit_neighbours(space.frame(), i, [&](std::size_t j) {
        if (!space.passable(j) || labels.of_cell[j] != kNoLabel) return;
        labels.of_cell[j] = labels.of_cell[i];
        next.push_back(j);
      });
    }
    front.swap(next);
  }
}

// Sizes of the labels and lengths of their borders, updated while labels are merged.
class Merger {
 public:
  Merger(const FreeSpace& space, const ZoneLabels& labels)
      : stays_(labels.stays),
        into_(labels.names.size()),
        cells_(labels.names.size(), 0),
        borders_(labels.names.size()) {
    for (std::uint32_t label = 0; label < into_.size(); ++label) into_[label] = label;
    for (std::size_t i = 0; i < labels.of_cell.size(); ++i) {
      const std::uint32_t label = labels.of_cell[i];
      if (label == kNoLabel) continue;
      ++cells_[label];
      visit_neighbours(space.frame(), i, [&](std::size_t j) {
        const std::uint32_t other = labels.of_cell[j];
        if (other != kNoLabel && other != label) ++borders_[label][other];
      });
    }
  }

  /// The smallest zones first, so that the order of the labels does not matter.
  void join_smaller_than(double cells) {
    std::set<std::pair<std::size_t, std::uint32_t>> small;
    const auto is_small = [&](std::uint32_t label) {
      return !stays_[label] && cells_[label] > 0 && static_cast<double>(cells_[label]) < cells &&
             !borders_[label].empty();
    };
    for (std::uint32_t label = 0; label < into_.size(); ++label) {
      if (is_small(label)) small.emplace(cells_[label], label);
    }
    while (!small.empty()) {
      const std::uint32_t label = small.begin()->second;
      small.erase(small.begin());
      const std::uint32_t to = longest_border(label);
      small.erase({cells_[to], to});
      join(label, to);
      if (is_small(to)) small.emplace(cells_[to], to);
    }
  }

  [[nodiscard]] std::uint32_t label_of(std::uint32_t label) const {
    while (into_[label] != label) label = into_[label];
    return label;
  }

 private:
  [[nodiscard]] std::uint32_t longest_border(std::uint32_t label) const {
    const auto& borders = borders_[label];
    return std::max_element(borders.begin(), borders.end(),
                            [](const auto& a, const auto& b) { return a.second < b.second; })
        ->first;
  }

  void join(std::uint32_t label, std::uint32_t to) {
    into_[label] = to;
    cells_[to] += cells_[label];
    cells_[label] = 0;
    for (const auto& [other, length] : borders_[label]) {
      borders_[other].erase(label);
      if (other == to) continue;
      borders_[other][to] += length;
      borders_[to][other] += length;
    }
    borders_[label].clear();
  }

  const std::vector<bool>& stays_;
  std::vector<std::uint32_t> into_;
  std::vector<std::size_t> cells_;
  std::vector<std::map<std::uint32_t, std::size_t>> borders_;
};

}  // namespace

void label_parts(const FreeSpace& space, const std::vector<std::uint32_t>& owner_of_cell,
                 const std::vector<std::string>& names, ZoneLabels& labels) {
  struct Part {
    std::uint32_t label;
    std::size_t cells;
  };
  std::vector<std::vector<Part>> parts_of(names.size());
  std::vector<std::size_t> open;
  for (std::size_t first = 0; first < owner_of_cell.size(); ++first) {
    const std::uint32_t owner = owner_of_cell[first];
    if (owner == kNoLabel || labels.of_cell[first] != kNoLabel) continue;
    const auto label = static_cast<std::uint32_t>(labels.names.size());
    labels.names.emplace_back();
    labels.stays.push_back(false);
    labels.of_cell[first] = label;
    std::size_t cells = 0;
    open.push_back(first);
    while (!open.empty()) {
      const std::size_t i = open.back();
      open.pop_back();
      ++cells;
      visit_neighbours(space.frame(), i, [&](std::size_t j) {
        if (owner_of_cell[j] != owner || labels.of_cell[j] != kNoLabel) return;
        labels.of_cell[j] = label;
        open.push_back(j);
      });
    }
    parts_of[owner].push_back({label, cells});
  }
  for (std::size_t owner = 0; owner < names.size(); ++owner) {
    std::vector<Part>& parts = parts_of[owner];
    if (names[owner].empty() || parts.empty()) continue;
    const auto largest = std::max_element(
        parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.cells < b.cells; });
    std::rotate(parts.begin(), largest, largest + 1);
    labels.stays[parts[0].label] = true;
    labels.names[parts[0].label] = names[owner];
    for (std::size_t k = 1; k < parts.size(); ++k) {
      labels.names[parts[k].label] = names[owner] + " " + std::to_string(k + 1);
    }
  }
}

std::vector<std::uint32_t> passable_owner(const FreeSpace& space) {
  std::vector<std::uint32_t> owner(space.frame().size());
  for (std::size_t i = 0; i < owner.size(); ++i) owner[i] = space.passable(i) ? 0 : kNoLabel;
  return owner;
}

ZoneMap complete(const FreeSpace& space, ZoneLabels labels, const ZoneConfig& config) {
  const GridFrame& frame = space.frame();
  grow(space, labels);
  label_parts(space, passable_owner(space), {""}, labels);
  Merger merger(space, labels);
  merger.join_smaller_than(config.min_area_m2 / (frame.resolution_m * frame.resolution_m));
  ZoneMap map;
  map.zone_of_cell.assign(frame.size(), kNoZone);
  std::vector<ZoneId> zone_of_label(labels.names.size(), kNoZone);
  for (std::size_t i = 0; i < frame.size(); ++i) {
    if (labels.of_cell[i] == kNoLabel) continue;
    const std::uint32_t label = merger.label_of(labels.of_cell[i]);
    const Cell cell = frame.cell_at(i);
    if (zone_of_label[label] == kNoZone) {
      if (map.zones.size() >= kNoZone) {
        throw std::invalid_argument("zones: there are more than " + std::to_string(kNoZone));
      }
      zone_of_label[label] = static_cast<ZoneId>(map.zones.size());
      map.zones.push_back({zone_of_label[label], labels.names[label], 0, {cell, cell}});
    }
    map.zone_of_cell[i] = zone_of_label[label];
    Zone& zone = map.zones[zone_of_label[label]];
    ++zone.cells;
    zone.box.low.column = std::min(zone.box.low.column, cell.column);
    zone.box.high.column = std::max(zone.box.high.column, cell.column);
    zone.box.high.row = cell.row;
  }
  return map;
}

}  // namespace topogeo::planning
