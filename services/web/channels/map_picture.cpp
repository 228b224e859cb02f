#include "channels/map_picture.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <stdexcept>

#include "channels/palette_png.hpp"

namespace topogeo::web {
namespace {

using planning::Cell;
using planning::CellState;

// Indices into the grid palette: the larger one wins when pixels are merged.
constexpr std::uint8_t kNothing = 0;
constexpr std::uint8_t kFree = 1;
constexpr std::uint8_t kOccupied = 2;

constexpr std::array<Color, 3> kGridColors = {
    {{255, 255, 255, 0}, {255, 255, 255, 255}, {32, 32, 32, 255}}};
constexpr std::array<Color, MapPicture::kColors + 1> kRoomColors = {{{255, 255, 255, 0},
                                                                     {0x8d, 0xd3, 0xc7, 255},
                                                                     {0xff, 0xff, 0xb3, 255},
                                                                     {0xbe, 0xba, 0xda, 255},
                                                                     {0xfb, 0x80, 0x72, 255},
                                                                     {0x80, 0xb1, 0xd3, 255},
                                                                     {0xfd, 0xb4, 0x62, 255}}};

std::span<const Color> palette_of(Layer layer) {
  return layer == Layer::kGrid ? std::span<const Color>(kGridColors) : kRoomColors;
}

constexpr std::uint16_t kInNoZone = 65535;

std::uint8_t color_of_state(std::uint8_t state) {
  switch (static_cast<CellState>(state)) {
    case CellState::kFree:
      return kFree;
    case CellState::kOccupied:
      return kOccupied;
    case CellState::kUnknown:
      break;
  }
  return kNothing;
}

}  // namespace

bool GridSquare::is_known() const {
  return std::ranges::any_of(states, [](std::uint8_t state) {
    return state != static_cast<std::uint8_t>(CellState::kUnknown);
  });
}

MapPicture::MapPicture(const planning::GridFrame& frame,
                       std::vector<std::shared_ptr<const GridSquare>> squares,
                       std::vector<std::uint8_t> zone_colors)
    : frame_(frame),
      squares_in_row_((frame.columns + kSquareCells - 1) / kSquareCells),
      squares_(std::move(squares)),
      zone_colors_(std::move(zone_colors)) {
  const std::int32_t rows = (frame.rows + kSquareCells - 1) / kSquareCells;
  if (squares_.size() !=
      static_cast<std::size_t>(squares_in_row_) * static_cast<std::size_t>(rows)) {
    throw std::invalid_argument("expected a square for each 64 x 64 cells of the grid");
  }
}

const GridSquare& MapPicture::square_of(const Cell& cell) const {
  const std::int32_t square =
      cell.row / kSquareCells * squares_in_row_ + cell.column / kSquareCells;
  return *squares_[static_cast<std::size_t>(square)];
}

namespace {

std::size_t index_in_square(const Cell& cell) {
  constexpr std::int32_t kSide = MapPicture::kSquareCells;
  const std::int32_t index = cell.row % kSide * kSide + cell.column % kSide;
  return static_cast<std::size_t>(index);
}

}  // namespace

CellState MapPicture::state_at(const Cell& cell) const {
  return static_cast<CellState>(square_of(cell).states.at(index_in_square(cell)));
}

std::optional<std::uint16_t> MapPicture::zone_at(const Cell& cell) const {
  const std::uint16_t zone = square_of(cell).zones.at(index_in_square(cell));
  if (zone == kInNoZone) return std::nullopt;
  return zone;
}

MapPicture::Image MapPicture::draw_cells(Layer layer) const {
  Image image{frame_.columns, frame_.rows, {}};
  image.pixels.resize(frame_.size());
  std::size_t at = 0;
  for (std::int32_t row = 0; row < frame_.rows; ++row) {
    for (std::int32_t column = 0; column < frame_.columns; ++column, ++at) {
      const Cell cell{column, row};
      const GridSquare& square = square_of(cell);
      const std::size_t index = index_in_square(cell);
      if (layer == Layer::kGrid) {
        image.pixels[at] = color_of_state(square.states[index]);
      } else if (square.zones[index] < zone_colors_.size()) {
        image.pixels[at] = static_cast<std::uint8_t>(zone_colors_[square.zones[index]] + 1);
      }
    }
  }
  return image;
}

MapPicture::Image MapPicture::half_of(const Image& image) {
  Image half{(image.columns + 1) / 2, (image.rows + 1) / 2, {}};
  half.pixels.resize(static_cast<std::size_t>(half.columns) * static_cast<std::size_t>(half.rows));
  for (std::int32_t row = 0; row < image.rows; ++row) {
    for (std::int32_t column = 0; column < image.columns; ++column) {
      std::uint8_t& out =
          half.pixels[static_cast<std::size_t>(row / 2) * static_cast<std::size_t>(half.columns) +
                      static_cast<std::size_t>(column / 2)];
      out = std::max(
          out,
          image.pixels[static_cast<std::size_t>(row) * static_cast<std::size_t>(image.columns) +
                       static_cast<std::size_t>(column)]);
    }
  }
  return half;
}

const MapPicture::Image& MapPicture::image(Layer layer, std::uint32_t level) const {
  const std::scoped_lock lock(mutex_);
  std::vector<Image>& images = images_.at(static_cast<std::size_t>(layer));
  images.reserve(kLevels);  // keeps references to the images valid
  if (images.empty()) images.push_back(draw_cells(layer));
  while (images.size() <= level) images.push_back(half_of(images.back()));
  return images[level];
}

std::optional<std::string> MapPicture::png(const TilePlace& place) const {
  if (place.level >= kLevels) return std::nullopt;
  const Image& from = image(place.layer, place.level);
  constexpr auto kSide = static_cast<std::uint32_t>(kTilePixels);
  const auto columns = static_cast<std::uint32_t>(from.columns);
  const auto rows = static_cast<std::uint32_t>(from.rows);
  if (place.column > columns / kSide || place.row > rows / kSide) return std::nullopt;
  std::vector<std::uint8_t> pixels(std::size_t{kSide} * kSide, kNothing);  // from the top row down
  bool anything = false;
  const std::uint32_t first_column = place.column * kSide;
  const std::uint32_t first_row = place.row * kSide;
  for (std::uint32_t row = first_row; row < std::min(first_row + kSide, rows); ++row) {
    for (std::uint32_t column = first_column; column < std::min(first_column + kSide, columns);
         ++column) {
      const std::uint8_t pixel = from.pixels[std::size_t{row} * columns + column];
      if (pixel == kNothing) continue;
      anything = true;
      pixels[std::size_t{kSide - 1 - (row - first_row)} * kSide + (column - first_column)] = pixel;
    }
  }
  if (!anything) return std::nullopt;
  return palette_png(kSide, kSide, pixels, palette_of(place.layer));
}

ColorImage MapPicture::colors(Layer layer, std::size_t most_pixels) const {
  std::uint32_t level = 0;
  while (level + 1 < kLevels && image(layer, level).pixels.size() > most_pixels) ++level;
  const Image& from = image(layer, level);
  ColorImage out{
      from.columns, from.rows, frame_.resolution_m * static_cast<double>(1U << level), {}};
  out.rgba.reserve(4 * from.pixels.size());
  const std::span<const Color> palette = palette_of(layer);
  for (const std::uint8_t pixel : from.pixels) {
    const Color& color = palette[pixel];
    for (const std::uint8_t part : {color.red, color.green, color.blue, color.alpha}) {
      out.rgba += static_cast<char>(part);
    }
  }
  return out;
}

}  // namespace topogeo::web
