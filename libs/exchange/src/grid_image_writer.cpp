#include <cmath>

#include "topogeo/exchange/grid_image.hpp"
#include "topogeo/planning/pgm_image.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/yaml_reader.hpp"

#include "text.hpp"

namespace topogeo::exchange {
namespace {

// Thresholds of map_saver: under 0.196, the pixel 205 is unknown for every reader.
constexpr const char* kOccupiedThreshold = "0.65";
constexpr const char* kFreeThreshold = "0.196";

std::uint8_t saver_pixel(planning::CellState state) {
  constexpr std::uint8_t kFree = 254;
  constexpr std::uint8_t kUnknown = 205;
  if (state == planning::CellState::kFree) return kFree;
  return state == planning::CellState::kOccupied ? 0 : kUnknown;
}

std::vector<OutputFile> image_and_yaml(const std::filesystem::path& path,
                                       const planning::GridFrame& frame,
                                       const std::vector<std::uint8_t>& from_below,
                                       const std::string& mode, const std::string& comment) {
  std::filesystem::path yaml = path;
  if (yaml.extension() == ".yaml" || yaml.extension() == ".pgm") yaml.replace_extension();
  std::filesystem::path image = yaml;
  yaml += ".yaml";
  image += ".pgm";
  planning::PgmImage pixels{frame.columns, frame.rows, 255, {}};
  pixels.pixels.reserve(frame.size());
  for (std::int32_t row = frame.rows - 1; row >= 0; --row) {
    const auto begin = from_below.begin() + static_cast<std::ptrdiff_t>(frame.index({0, row}));
    pixels.pixels.insert(pixels.pixels.end(), begin, begin + frame.columns);
  }
  const geometry::Pose2& origin = frame.T_map_grid;
  const std::string text = fmt::format(
      "{}image: {}\nmode: {}\nresolution: {}\norigin: [{}, {}, 0]\nnegate: 0\n"
      "occupied_thresh: {}\nfree_thresh: {}\n",
      comment, support::yaml_scalar(image.filename().string()), mode,
      number_text(frame.resolution_m), number_text(origin.x_m), number_text(origin.y_m),
      kOccupiedThreshold, kFreeThreshold);
  return {{image, planning::pgm_bytes(pixels, false)}, {yaml, text}};
}

}  // namespace

planning::OccupancyGrid without_turn(const planning::OccupancyGrid& grid) {
  const planning::GridFrame& turned = grid.frame();
  if (turned.T_map_grid.theta_rad == 0.0) return grid;
  Eigen::Vector2d low = turned.T_map_grid.position_m();
  Eigen::Vector2d high = low;
  for (const double x : {0.0, turned.columns * turned.resolution_m}) {
    for (const double y : {0.0, turned.rows * turned.resolution_m}) {
      const Eigen::Vector2d corner = turned.T_map_grid * Eigen::Vector2d(x, y);
      low = low.cwiseMin(corner);
      high = high.cwiseMax(corner);
    }
  }
  planning::GridFrame frame;
  frame.resolution_m = turned.resolution_m;
  const auto cells = [&](double m) { return std::floor(m / frame.resolution_m); };
  frame.T_map_grid = {cells(low.x()) * frame.resolution_m, cells(low.y()) * frame.resolution_m,
                      0.0};
  // A grid of 20,000 cells a side is refused below, so the numbers fit.
  frame.columns = static_cast<std::int32_t>(cells(high.x()) - cells(low.x())) + 1;
  frame.rows = static_cast<std::int32_t>(cells(high.y()) - cells(low.y())) + 1;
  planning::OccupancyGrid out(frame);
  for (std::size_t i = 0; i < frame.size(); ++i) {
    const planning::Cell cell = frame.cell_at(i);
    const auto source = turned.cell_of(frame.center_m(cell));
    if (source) out.set(cell, grid.at(*source));
  }
  return out;
}

std::vector<OutputFile> grid_files(const std::filesystem::path& path,
                                   const planning::OccupancyGrid& grid) {
  const planning::OccupancyGrid straight = without_turn(grid);
  std::vector<std::uint8_t> pixels;
  pixels.reserve(straight.frame().size());
  for (const planning::CellState state : straight.cells()) pixels.push_back(saver_pixel(state));
  return image_and_yaml(path, straight.frame(), pixels, "trinary", "");
}

std::vector<OutputFile> raw_files(const std::filesystem::path& path,
                                  const planning::GridFrame& frame,
                                  const std::vector<std::uint8_t>& values,
                                  const std::string& comment) {
  return image_and_yaml(path, frame, values, "raw", comment);
}

}  // namespace topogeo::exchange
