#include "topogeo/planning/grid_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <stdexcept>

#include <yaml-cpp/yaml.h>

#include "topogeo/support/atomic_file.hpp"

#include "pgm_image.hpp"
#include "text_file.hpp"

namespace topogeo::planning {
namespace {

// What map_saver of ROS writes; map_server reads any.
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

class DescriptionReader {
 public:
  explicit DescriptionReader(std::string source) : source_(std::move(source)) {}

  GridDescription read(const YAML::Node& root) {
    if (!root.IsMap()) fail(root, "the file", "lines of 'key: value'");
    check_keys(root);
    GridDescription description;
    description.image = required(root, "image").Scalar();
    if (description.image.empty()) fail(root["image"], "image", "the name of a PGM file");
    description.frame.resolution_m =
        number(required(root, "resolution"), "resolution", 0.01, 1.0, "m");
    description.frame.T_map_grid = origin(required(root, "origin"));
    description.negate = number(required(root, "negate"), "negate", 0.0, 1.0, "") != 0.0;
    description.occupied_threshold =
        number(required(root, "occupied_thresh"), "occupied_thresh", 0.0, 1.0, "");
    description.free_threshold = number(required(root, "free_thresh"), "free_thresh", 0.0,
                                        description.occupied_threshold, "");
    const YAML::Node mode = root["mode"];
    if (mode.IsDefined() && (!mode.IsScalar() || mode.Scalar() != "trinary")) {
      fail(mode, "mode", "trinary");
    }
    return description;
  }

 private:
  [[noreturn]] void fail(const YAML::Node& at, const std::string& field,
                         const std::string& expected) const {
    fail_in_yaml(source_, at, field, expected);
  }

  void check_keys(const YAML::Node& root) const {
    constexpr std::array<std::string_view, 7> kKnown = {
        "image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh", "mode"};
    std::set<std::string> seen;
    for (const auto& entry : root) {
      const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "";
      if (std::find(kKnown.begin(), kKnown.end(), key) == kKnown.end()) {
        fail(entry.first, "key",
             "image, resolution, origin, negate, occupied_thresh, free_thresh or mode");
      }
      if (!seen.insert(key).second) fail(entry.first, key, "each key once");
    }
  }

  [[nodiscard]] YAML::Node required(const YAML::Node& root, const std::string& key) const {
    const YAML::Node node = root[key];
    if (!node.IsDefined()) {
      throw std::runtime_error(source_ + ": key '" + key + "' is missing");
    }
    if (key != "origin" && !node.IsScalar()) fail(node, key, "a single value");
    return node;
  }

  [[nodiscard]] double number(const YAML::Node& node, const std::string& field, double low,
                              double high, const std::string& unit) const {
    return number_in_yaml(source_, node, field, low, high, unit);
  }

  [[nodiscard]] geometry::Pose2 origin(const YAML::Node& node) const {
    if (!node.IsSequence() || node.size() != 3) fail(node, "origin", "[x, y, yaw]");
    constexpr double kMost_m = 1e6;
    constexpr double kMost_rad = 7.0;
    return {number(node[0], "origin x", -kMost_m, kMost_m, "m"),
            number(node[1], "origin y", -kMost_m, kMost_m, "m"),
            number(node[2], "origin yaw", -kMost_rad, kMost_rad, "rad")};
  }

  std::string source_;
};

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

// The shortest text that reads back to the same value.
std::string text_of(double value) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  return {buffer.data(), end};
}

}  // namespace

OccupancyGrid read_grid(const std::filesystem::path& yaml_path) {
  const GridDescription description =
      DescriptionReader(yaml_path.string())
          .read(parse_yaml(read_text_file(yaml_path), yaml_path.string()));
  const std::filesystem::path image_path = yaml_path.parent_path() / description.image;
  const PgmImage image = parse_pgm(read_text_file(image_path), image_path.string());
  GridFrame frame = description.frame;
  frame.columns = image.width;
  frame.rows = image.height;
  OccupancyGrid grid(frame);
  for (std::int32_t row = 0; row < frame.rows; ++row) {
    for (std::int32_t column = 0; column < frame.columns; ++column) {
      // The image's first row is the farthest up.
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
  YAML::Emitter name;
  name << image_path.filename().string();
  std::ostringstream yaml;
  yaml << "image: " << name.c_str() << "\nresolution: " << text_of(frame.resolution_m)
       << "\norigin: [" << text_of(origin.x_m) << ", " << text_of(origin.y_m) << ", "
       << text_of(origin.theta_rad)
       << "]\nnegate: 0\noccupied_thresh: " << text_of(kOccupiedThreshold)
       << "\nfree_thresh: " << text_of(kFreeThreshold) << '\n';
  support::write_file_atomically(yaml_path, yaml.str());
}

}  // namespace topogeo::planning
