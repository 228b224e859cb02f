#include <stdexcept>
#include <string>
#include <string_view>

#include "topogeo/exchange/map_formats.hpp"
#include "topogeo/exchange/read_text.hpp"
#include "topogeo/support/foreign_file.hpp"
#include "topogeo/support/lower_case.hpp"
#include "topogeo/support/yaml_reader.hpp"

#include "json_reader.hpp"
#include "raster_image.hpp"

namespace topogeo::exchange {
namespace {

namespace fs = std::filesystem;

FormatGuess guess_json(const fs::path& file) {
  const nlohmann::ordered_json json = parse_json(read_text(file), file.string());
  const auto has = [&](const char* key) { return json.is_object() && json.contains(key); };
  if (has("features") || (has("type") && json["type"] == "FeatureCollection")) {
    return {"geojson", "it has features"};
  }
  if (has("layouts") || has("origins")) return {"lif", "it has layouts"};
  if (has("zoneSet") || has("zones")) return {"zones", "it has a zone set"};
  return {};
}

FormatGuess guess_yaml(const fs::path& file) {
  const support::YamlNode root = support::parse_yaml(
      support::foreign_content(file, support::kMostYamlBytes), file.string(), "the file");
  const auto has = [&](const char* key) { return root.is_map() && root.at(key).exists(); };
  if (has("image")) return {"pgm", "it names an image"};
  for (const char* key : {"zones", "places", "walls", "doors", "openings"}) {
    if (has(key)) return {"drawing", std::string("it has ") + key};
  }
  return {};
}

FormatGuess guess_by_content(const fs::path& file) {
  constexpr std::size_t kStart = 512;
  const std::string start = support::first_bytes(file, kStart);
  if (is_raster_image(start)) return {"pgm", "it is an image"};
  const std::size_t first = start.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  if (first == std::string::npos) return {};
  if (start[first] == '<') {
    return start.find("graphml") == std::string::npos ? FormatGuess{}
                                                      : FormatGuess{"graphml", "it is GraphML"};
  }
  const std::string ending = support::lower_case(file.extension().string());
  const bool is_json = ending == ".json" || ending == ".geojson";
  const bool is_yaml = ending == ".yaml" || ending == ".yml";
  try {
    return is_json || (!is_yaml && start[first] == '{') ? guess_json(file) : guess_yaml(file);
  } catch (const std::runtime_error&) {
    if (is_json || is_yaml) throw;  // the ending says what is wrong with the content
    return {};
  }
}

}  // namespace

FormatGuess guess_import_format(const fs::path& file) {
  if (support::lower_case(file.filename().string()).ends_with(".world.yaml")) {
    return {"drawing", "its name ends in .world.yaml"};
  }
  FormatGuess guess = guess_by_content(file);
  if (!guess.format.empty()) return guess;
  std::string names;
  for (const MapFormat& format : import_formats()) {
    names += (names.empty() ? "" : ", ") + std::string(format.name);
  }
  throw std::runtime_error(
      file.string() + ": its content does not show the format: expected --format with one of " +
      names);
}

}  // namespace topogeo::exchange
