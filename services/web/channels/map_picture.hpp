// The grid of a map as pictures of 256 x 256 pixels at several scales, with lookup by cell.
//
// At level n a pixel is 2^n x 2^n cells: occupied if any of them is, otherwise free if any is.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/planning/occupancy_grid.hpp"

namespace topogeo::web {

/// A received square of 64 x 64 cells, row by row from the lower left one; cells beyond the grid
/// are unknown.
struct GridSquare {
  std::uint64_t version = 0;
  std::vector<std::uint8_t> states;  ///< planning::CellState
  std::vector<std::uint16_t> zones;  ///< 65535: in none
  [[nodiscard]] bool is_known() const;
};

enum class Layer : std::uint8_t { kGrid, kRooms };

/// Position of a tile: its lower left pixel is cell (256 * 2^level * column, 256 * 2^level * row).
struct TilePlace {
  Layer layer = Layer::kGrid;
  std::uint32_t level = 0;
  std::uint32_t column = 0;
  std::uint32_t row = 0;
};

struct ColorImage {
  std::int32_t columns = 0;
  std::int32_t rows = 0;
  double pixel_m = 0.0;
  std::string rgba;
};

/// The pictures of one map version. Immutable and thread-safe.
class MapPicture {
 public:
  static constexpr std::int32_t kSquareCells = 64;
  static constexpr std::int32_t kTilePixels = 256;
  static constexpr std::uint32_t kLevels = 9;
  static constexpr std::uint8_t kColors = 6;

  /// `squares` by number, row * ceil(columns / 64) + column. `zone_colors`: 0 to kColors - 1, by
  /// zone.
  MapPicture(const planning::GridFrame& frame,
             std::vector<std::shared_ptr<const GridSquare>> squares,
             std::vector<std::uint8_t> zone_colors);

  /// PNG with a palette; nothing for a tile without known cells (Layer::kGrid) or without zones
  /// (Layer::kRooms), and beyond the grid.
  [[nodiscard]] std::optional<std::string> png(const TilePlace& place) const;

  /// The whole picture with four bytes per pixel (red, green, blue, alpha), row by row from the
  /// lower left one, at the finest level that has at most `most_pixels`.
  [[nodiscard]] ColorImage colors(Layer layer, std::size_t most_pixels) const;

  /// State of a grid cell.
  [[nodiscard]] planning::CellState state_at(const planning::Cell& cell) const;
  [[nodiscard]] std::optional<std::uint16_t> zone_at(const planning::Cell& cell) const;
  [[nodiscard]] const planning::GridFrame& frame() const { return frame_; }

 private:
  /// Indices of the palette, row by row from the lower left pixel.
  struct Image {
    std::int32_t columns = 0;
    std::int32_t rows = 0;
    std::vector<std::uint8_t> pixels;
  };

  [[nodiscard]] const GridSquare& square_of(const planning::Cell& cell) const;
  [[nodiscard]] Image draw_cells(Layer layer) const;
  [[nodiscard]] static Image half_of(const Image& image);
  [[nodiscard]] const Image& image(Layer layer, std::uint32_t level) const;

  planning::GridFrame frame_;
  std::int32_t squares_in_row_;
  std::vector<std::shared_ptr<const GridSquare>> squares_;
  std::vector<std::uint8_t> zone_colors_;
  mutable std::mutex mutex_;
  mutable std::array<std::vector<Image>, 2> images_;  // by layer and level, made on demand
};

}  // namespace topogeo::web
