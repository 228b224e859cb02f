#include "resources.hpp"

#include <array>
#include <charconv>
#include <optional>
#include <stdexcept>
#include <system_error>

#include "server/json_values.hpp"

namespace topogeo::web {
namespace {

template <class Number>
std::optional<Number> number_of(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Parts between slashes.
std::vector<std::string_view> parts_of(std::string_view path) {
  std::vector<std::string_view> parts;
  while (path.starts_with('/')) {
    path.remove_prefix(1);
    const std::size_t end = path.find('/');
    parts.push_back(path.substr(0, end));
    path.remove_prefix(end == std::string_view::npos ? path.size() : end);
  }
  return parts;
}

/// Place given by the parts "tiles", layer, frame, level, column, "row.png".
std::optional<TilePlace> tile_place(const std::vector<std::string_view>& parts) {
  constexpr std::size_t kParts = 6;
  constexpr std::string_view kEnd = ".png";
  if (parts.size() != kParts || !parts[5].ends_with(kEnd)) return std::nullopt;
  if (parts[1] != "grid" && parts[1] != "rooms") return std::nullopt;
  const auto level = number_of<std::uint32_t>(parts[3]);
  const auto column = number_of<std::uint32_t>(parts[4]);
  const auto row = number_of<std::uint32_t>(parts[5].substr(0, parts[5].size() - kEnd.size()));
  if (!level || !column || !row) return std::nullopt;
  return TilePlace{parts[1] == "grid" ? Layer::kGrid : Layer::kRooms, *level, *column, *row};
}

const char* word_of(planning::CellState state) {
  switch (state) {
    case planning::CellState::kFree:
      return "free";
    case planning::CellState::kOccupied:
      return "occupied";
    case planning::CellState::kUnknown:
      break;
  }
  return "unknown";
}

}  // namespace

std::string query_value(std::string_view query, std::string_view key) {
  while (!query.empty()) {
    const std::size_t end = query.find('&');
    const std::string_view pair = query.substr(0, end);
    const std::size_t equals = pair.find('=');
    if (equals != std::string_view::npos && pair.substr(0, equals) == key) {
      return std::string(pair.substr(equals + 1));
    }
    query.remove_prefix(end == std::string_view::npos ? query.size() : end + 1);
  }
  return {};
}

std::uint64_t parse_number(std::string_view text, const char* key) {
  const auto number = number_of<std::uint64_t>(text);
  if (!number) throw std::invalid_argument(std::string(key) + ": expected a whole number");
  return *number;
}

Answer tile_answer(const Request& request, const ShownMap* map) {
  const std::vector<std::string_view> parts = parts_of(request.path);
  const auto place = tile_place(parts);
  if (!place) return error_answer(404, "expected /tiles/grid|rooms/FRAME/LEVEL/COLUMN/ROW.png");
  if (map == nullptr || parts[2] != map->frame)
    return error_answer(404, "another map is shown now");
  std::optional<std::string> png = map->picture->png(*place);
  if (!png) return error_answer(404, "no data at this tile");
  Answer answer;
  answer.body = std::move(*png);
  answer.content_type = "image/png";
  answer.cacheable = !query_value(request.query, "v").empty();
  return answer;
}

Answer point_answer(const Request& request, const ShownMap* map) {
  const auto x_m = number_of<double>(query_value(request.query, "x_m"));
  const auto y_m = number_of<double>(query_value(request.query, "y_m"));
  if (!x_m || !y_m) return error_answer(400, "expected x_m and y_m, metres in the map");
  if (map == nullptr) return error_answer(409, "there is no map yet");
  Answer answer;
  Json json = {{"inside", false}};
  if (const auto cell = map->picture->frame().cell_of({*x_m, *y_m})) {
    const auto zone = map->picture->zone_at(*cell);
    json = {{"inside", true},
            {"cell", word_of(map->picture->state_at(*cell))},
            {"reachable", zone.has_value()}};
    if (zone) {
      json["zone"] = *zone;
      if (*zone < map->rooms.size()) json["room"] = map->rooms[*zone];
    }
  }
  answer.body = text_of(json);
  return answer;
}

}  // namespace topogeo::web
