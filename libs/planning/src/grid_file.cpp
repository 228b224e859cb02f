#include "topogeo/planning/grid_file.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>

#include "topogeo/planning/pgm_image.hpp"
#include "topogeo/support/atomic_file.hpp"
#include "topogeo/support/yaml_reader.hpp"

#include "text_file.hpp"

namespace topogeo::planning {
namespace {

using support::YamlNode;

// Thresholds of map_saver of ROS; map_server reads any.
constexpr double kOccupiedThreshold = 0.65;
constexpr double kFreeThreshold = 0.196;
constexpr int kFreePixel = 254;
constexpr int kUnknownPixel = 205;

struct GridDescription {
  std::filesystem::path image;
  GridFrame frame;  // without columns and rows
  bool negate = false;
  double occupied_threshold = kOccupiedThreshold;
  double free_threshold = kFreeThreshold;
};

geometry::Pose2 origin_of(const YamlNode& node) {
  const std::vector<YamlNode> items = node.tuple(3, "[x, y, yaw]");
  // 1,000 km and more than a turn: larger values are mistakes.
  constexpr double kMost_m = 1e6;
  constexpr double kMost_rad = 7.0;
  return {items[0].named("origin x").number(-kMost_m, kMost_m, "m"),
          items[1].named("origin y").number(-kMost_m, kMost_m, "m"),
          items[2].named("origin yaw").number(-kMost_rad, kMost_rad, "rad")};
}

GridDescription read_description(const YamlNode& root) {
  root.allow_keys(
      {"image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh", "mode"});
  GridDescription description;
  description.image = root.required("image").text();
  if (description.image.empty()) root.at("image").fail("the name of a PGM file");
  description.frame.resolution_m = root.required("resolution").number(0.01, 1.0, "m");
  description.frame.T_map_grid = origin_of(root.required("origin"));
  description.negate = root.required("negate").number(0.0, 1.0, "") != 0.0;
  description.occupied_threshold = root.required("occupied_thresh").number(0.0, 1.0, "");
  description.free_threshold =
      root.required("free_thresh").number(0.0, description.occupied_threshold, "");
  const YamlNode mode = root.at("mode");
  if (mode.exists() && mode.scalar() != "trinary") mode.fail("trinary");
  return description;
}

CellState state_of(int pixel, int depth, const GridDescription& description) {
  const double light = static_cast<double>(pixel) / depth;
  const double occupied = description.negate ? light : 1.0 - light;
  if (occupied > description.occupied_threshold) return CellState::kOccupied;
  return occupied < description.free_threshold ? CellState::kFree : CellState::kUnknown;
}

int pixel_of(CellState state) {
  if (state == CellState::kFree) return kFreePixel;
  return state == CellState::kOccupied ? 0 : kUnknownPixel;
}

// The shortest text that reproduces the value.
std::string text_of(double value) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  return {buffer.data(), end};
}

}  // namespace

OccupancyGrid read_grid(const std::filesystem::path& yaml_path) {
  const GridDescription description =
      read_description(support::parse_yaml(read_yaml_file(yaml_path), yaml_path.string(), "keys"));
  const std::filesystem::path image_path = yaml_path.parent_path() / description.image;
  const PgmImage image = parse_pgm(read_image_file(image_path), image_path.string());
  GridFrame frame = description.frame;
  frame.columns = image.width;
  frame.rows = image.height;
  OccupancyGrid grid(frame);
  for (std::int32_t row = 0; row < frame.rows; ++row) {
    for (std::int32_t column = 0; column < frame.columns; ++column) {
      // The image's first row is the top one.
      const std::size_t i = frame.index({column, frame.rows - 1 - row});
      grid.set({column, row}, state_of(image.pixels[i], image.depth, description));
    }
  }
  return grid;
}

void write_grid(const std::filesystem::path& yaml_path, const OccupancyGrid& grid, PgmForm form) {
  const GridFrame& frame = grid.frame();
  PgmImage image;
  image.width = frame.columns;
  image.height = frame.rows;
  image.pixels.reserve(frame.size());
  for (std::int32_t row = frame.rows - 1; row >= 0; --row) {
    for (std::int32_t column = 0; column < frame.columns; ++column) {
      image.pixels.push_back(static_cast<std::uint8_t>(pixel_of(grid.at({column, row}))));
    }
  }
  std::filesystem::path image_path = yaml_path;
  image_path.replace_extension(".pgm");
  support::write_file_atomically(image_path, pgm_bytes(image, form == PgmForm::kText));
  const geometry::Pose2& origin = frame.T_map_grid;
  std::ostringstream yaml;
  yaml << "image: " << support::yaml_scalar(image_path.filename().string())
       << "\nresolution: " << text_of(frame.resolution_m) << "\norigin: [" << text_of(origin.x_m)
       << ", " << text_of(origin.y_m) << ", " << text_of(origin.theta_rad)
       << "]\nnegate: 0\noccupied_thresh: " << text_of(kOccupiedThreshold)
       << "\nfree_thresh: " << text_of(kFreeThreshold) << '\n';
  support::write_file_atomically(yaml_path, yaml.str());
}

}  // namespace topogeo::planning
