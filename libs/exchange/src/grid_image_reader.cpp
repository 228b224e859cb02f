#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "topogeo/exchange/grid_image.hpp"
#include "topogeo/support/foreign_file.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/lower_case.hpp"
#include "topogeo/support/yaml_reader.hpp"

#include "raster_image.hpp"

namespace topogeo::exchange {
namespace {

using support::YamlNode;

/// The pixel that map_saver writes for an unknown cell.
constexpr int kUnknownPixel = 205;

struct ImageYaml {
  std::filesystem::path image;
  planning::GridFrame frame;  // without columns and rows
  bool negate = false;
  // map_server compares in 32 bits.
  float occupied = 0.0F;
  float free = 0.0F;
  ImageMode mode = ImageMode::kTrinary;
};

bool negate_of(const YamlNode& node) {
  const std::string word = support::lower_case(node.text());
  if (word == "1" || word == "true") return true;
  if (word == "0" || word == "false") return false;
  node.fail("0, 1, true or false");
}

ImageMode mode_of(const YamlNode& node) {
  if (!node.exists()) return ImageMode::kTrinary;
  const std::string word = support::lower_case(node.text());
  if (word == "trinary") return ImageMode::kTrinary;
  if (word == "scale") return ImageMode::kScale;
  if (word == "raw") return ImageMode::kRaw;
  node.fail("trinary, scale or raw");
}

void note_unknown_keys(const YamlNode& root, Notes& notes) {
  constexpr std::array<std::string_view, 7> kKnown = {
      "image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh", "mode"};
  for (const support::YamlEntry& entry : root.entries()) {
    const std::string key = entry.key.text();
    if (std::ranges::find(kKnown, key) == kKnown.end()) {
      notes.push_back(
          fmt::format("line {}: key '{}' is not known, ignored", entry.key.line(), key));
    }
  }
}

ImageYaml read_image_yaml(const YamlNode& root) {
  constexpr double kFarthest_m = 1e6;  // 1,000 km: a larger number is a mistake
  constexpr double kMostTurn_rad = 7.0;
  ImageYaml yaml;
  yaml.image = root.required("image").text();
  if (yaml.image.empty()) root.at("image").fail("the name of an image");
  yaml.frame.resolution_m = root.required("resolution").number(0.01, 1.0, "m");
  const std::vector<YamlNode> origin = root.required("origin").tuple(3, "[x, y, yaw]");
  yaml.frame.T_map_grid = {
      origin[0].named("origin x").number(-kFarthest_m, kFarthest_m, "m"),
      origin[1].named("origin y").number(-kFarthest_m, kFarthest_m, "m"),
      origin[2].named("origin yaw").number(-kMostTurn_rad, kMostTurn_rad, "rad")};
  yaml.negate = negate_of(root.required("negate"));
  yaml.occupied = static_cast<float>(root.required("occupied_thresh").number(0.0, 1.0, ""));
  yaml.free = static_cast<float>(root.required("free_thresh").number(0.0, 1.0, ""));
  yaml.mode = mode_of(root.at("mode"));
  return yaml;
}

/// `see_through`: unknown for map_server since Jazzy, except in mode raw.
std::int8_t value_of(std::uint16_t pixel, int depth, const ImageYaml& yaml,
                     bool see_through = false) {
  if (yaml.mode == ImageMode::kRaw) {
    const long value = std::lround(255.0 * pixel / depth);
    return value <= 100 ? static_cast<std::int8_t>(value) : std::int8_t{-1};
  }
  if (see_through) return -1;
  const float light = static_cast<float>(pixel) / static_cast<float>(depth);
  const float occupied = yaml.negate ? light : 1.0F - light;
  // If both thresholds apply, free wins.
  if (occupied <= yaml.free) return 0;
  if (occupied >= yaml.occupied) return 100;
  if (yaml.mode == ImageMode::kTrinary) return -1;
  return static_cast<std::int8_t>(
      std::lround((occupied - yaml.free) / (yaml.occupied - yaml.free) * 100.0F));
}

/// A pixel of 8 bits in the depth of an image.
std::uint16_t in_depth(int pixel, const RasterImage& image) {
  return static_cast<std::uint16_t>(pixel * (image.white / 255));
}

/// Whether map_saver may have written the image: it has no value but 0, 205 and 254, for which some
/// editors write 255.
bool has_values_of_map_saver(const RasterImage& image) {
  const std::array<std::uint16_t, 4> values = {in_depth(0, image), in_depth(kUnknownPixel, image),
                                               in_depth(254, image), in_depth(255, image)};
  return std::ranges::all_of(image.grey, [&](std::uint16_t pixel) {
    return std::ranges::find(values, pixel) != values.end();
  });
}

/// The pixel that is unknown although the thresholds make it free. A note tells how it was read.
std::optional<std::uint16_t> unknown_pixel(const ImageYaml& yaml, const RasterImage& image,
                                           Pixel205 pixel_205, Notes& notes) {
  if (yaml.mode != ImageMode::kTrinary || yaml.negate || image.white % 255 != 0) return {};
  const std::uint16_t pixel = in_depth(kUnknownPixel, image);
  if (std::ranges::find(image.grey, pixel) == image.grey.end()) return {};
  if (value_of(pixel, image.white, yaml) != 0) return {};
  if (pixel_205 == Pixel205::kThreshold ||
      (pixel_205 == Pixel205::kAutomatic && !has_values_of_map_saver(image))) {
    notes.push_back(fmt::format(
        "free_thresh {:g} makes free what map_saver writes as unknown (205); 0.196 would not",
        yaml.free));
    return {};
  }
  notes.push_back(
      fmt::format("pixels of 205 are unknown, as map_saver writes them, although free_thresh {:g} "
                  "would make them free (--pixel-205 threshold)",
                  yaml.free));
  return pixel;
}

}  // namespace

GridImage read_grid_image(const std::filesystem::path& yaml_path, Pixel205 pixel_205) {
  const YamlNode root = support::parse_yaml(
      support::foreign_content(yaml_path, support::kMostYamlBytes), yaml_path.string(), "keys");
  const ImageYaml yaml = read_image_yaml(root);
  GridImage grid;
  note_unknown_keys(root, grid.notes);
  const std::filesystem::path image_path = yaml_path.parent_path() / yaml.image;
  const RasterImage image = parse_raster_image(
      support::foreign_content(image_path, support::kMostImageBytes), image_path.string());
  const auto unknown = unknown_pixel(yaml, image, pixel_205, grid.notes);
  grid.mode = yaml.mode;
  grid.frame = yaml.frame;
  grid.frame.columns = image.width;
  grid.frame.rows = image.height;
  grid.values.reserve(grid.frame.size());
  for (std::int32_t row = grid.frame.rows - 1; row >= 0; --row) {
    for (std::int32_t column = 0; column < grid.frame.columns; ++column) {
      const std::size_t i = grid.frame.index({column, row});
      const bool see_through = !image.see_through.empty() && image.see_through[i] != 0;
      grid.values.push_back(image.grey[i] == unknown
                                ? std::int8_t{-1}
                                : value_of(image.grey[i], image.white, yaml, see_through));
    }
  }
  return grid;
}

planning::OccupancyGrid occupancy_of(const GridImage& image) {
  constexpr std::int8_t kFreeTo = 19;
  constexpr std::int8_t kOccupiedFrom = 65;
  planning::OccupancyGrid grid(image.frame);
  for (std::size_t i = 0; i < image.values.size(); ++i) {
    const std::int8_t value = image.values[i];
    if (value < 0) continue;
    const planning::Cell cell = image.frame.cell_at(i);
    if (value >= kOccupiedFrom) grid.set(cell, planning::CellState::kOccupied);
    if (value <= kFreeTo) grid.set(cell, planning::CellState::kFree);
  }
  return grid;
}

}  // namespace topogeo::exchange
