#include "topogeo/planning/place_names.hpp"

#include <algorithm>
#include <numeric>

namespace topogeo::planning {
namespace {

std::string in_small_letters(std::string_view text) {
  std::string small(text);
  for (char& c : small) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return small;
}

// Levenshtein's distance, row by row.
std::size_t changes(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t k = 1; k <= b.size(); ++k) {
      const std::size_t exchanged = diagonal + (a[i - 1] == b[k - 1] ? 0 : 1);
      diagonal = row[k];
      row[k] = std::min({exchanged, row[k] + 1, row[k - 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

const Place* find_place(std::span<const Place> places, std::string_view name) {
  const std::string small = in_small_letters(name);
  const Place* alike = nullptr;
  std::size_t count = 0;
  for (const Place& place : places) {
    if (place.name == name) return &place;
    if (in_small_letters(place.name) != small) continue;
    alike = &place;
    ++count;
  }
  return count == 1 ? alike : nullptr;
}

const Place* find_base_station(std::span<const Place> places, std::string_view name) {
  const Place* named = find_place(places, name);
  if (named != nullptr && named->station_heading_rad) return named;
  const auto is_station = [](const Place& place) { return place.station_heading_rad.has_value(); };
  if (std::count_if(places.begin(), places.end(), is_station) == 1) {
    return &*std::find_if(places.begin(), places.end(), is_station);
  }
  return named;
}

std::vector<std::string> similar_names(std::span<const Place> places, std::string_view name,
                                       std::size_t most) {
  const std::string small = in_small_letters(name);
  std::vector<std::pair<std::size_t, const Place*>> ranked;
  ranked.reserve(places.size());
  for (const Place& place : places) {
    ranked.emplace_back(changes(in_small_letters(place.name), small), &place);
  }
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string> names;
  for (std::size_t i = 0; i < std::min(most, ranked.size()); ++i) {
    names.push_back(ranked[i].second->name);
  }
  return names;
}

}  // namespace topogeo::planning
