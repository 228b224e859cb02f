#include "channels/map_picture.hpp"

#include <cstring>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <png.h>

#include "resources.hpp"

namespace topogeo::web {
namespace {

using planning::Cell;
using planning::CellState;

/// A floor of 100 x 70 cells, all unknown except those that a test sets.
class Floor {
 public:
  Floor() {
    frame_.columns = 100;
    frame_.rows = 70;
    frame_.resolution_m = 0.1;
    for (int i = 0; i < 4; ++i) {
      GridSquare square;
      square.version = 3;
      square.states.assign(4096, static_cast<std::uint8_t>(CellState::kUnknown));
      square.zones.assign(4096, 65535);
      squares_.push_back(square);
    }
  }
  void set(const Cell& cell, CellState state, std::uint16_t zone = 65535) {
    GridSquare& square = squares_.at(static_cast<std::size_t>(cell.row / 64) * 2 +
                                     static_cast<std::size_t>(cell.column / 64));
    const auto index = static_cast<std::size_t>(cell.row % 64 * 64 + cell.column % 64);
    square.states.at(index) = static_cast<std::uint8_t>(state);
    square.zones.at(index) = zone;
  }
  [[nodiscard]] std::shared_ptr<const MapPicture> shared() const {
    std::vector<std::shared_ptr<const GridSquare>> squares;
    for (const GridSquare& square : squares_) {
      squares.push_back(std::make_shared<const GridSquare>(square));
    }
    return std::make_shared<const MapPicture>(frame_, squares, std::vector<std::uint8_t>{2, 4});
  }
  [[nodiscard]] std::optional<std::string> png(const TilePlace& place) const {
    return shared()->png(place);
  }

 private:
  planning::GridFrame frame_;
  std::vector<GridSquare> squares_;
};

/// Red, green, blue and alpha of a pixel, counted from the upper left.
std::uint32_t pixel(const std::string& png, std::uint32_t column, std::uint32_t row) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  EXPECT_NE(png_image_begin_read_from_memory(&image, png.data(), png.size()), 0);
  EXPECT_EQ(image.width, 256U);
  EXPECT_EQ(image.height, 256U);
  image.format = PNG_FORMAT_RGBA;
  std::vector<std::uint8_t> bytes(PNG_IMAGE_SIZE(image));
  EXPECT_NE(png_image_finish_read(&image, nullptr, bytes.data(), 0, nullptr), 0);
  const std::uint8_t* at = bytes.data() + std::size_t{4} * (std::size_t{row} * 256 + column);
  return static_cast<std::uint32_t>(at[0]) << 24U | static_cast<std::uint32_t>(at[1]) << 16U |
         static_cast<std::uint32_t>(at[2]) << 8U | at[3];
}

constexpr std::uint32_t kWhite = 0xffffffff;
constexpr std::uint32_t kDark = 0x202020ff;
constexpr std::uint32_t kClear = 0xffffff00;

TEST(MapPicture, ACellIsAPixelCountedFromTheLowerLeft) {
  Floor floor;
  floor.set({0, 0}, CellState::kFree);
  floor.set({70, 65}, CellState::kOccupied);
  const auto png = floor.png({Layer::kGrid, 0, 0, 0});
  ASSERT_TRUE(png);
  EXPECT_EQ(pixel(*png, 0, 255), kWhite);
  EXPECT_EQ(pixel(*png, 70, 255 - 65), kDark);
  EXPECT_EQ(pixel(*png, 1, 255), kClear);
  EXPECT_EQ(pixel(*png, 200, 0), kClear) << "beyond the grid";
}

TEST(MapPicture, FartherAwayWallsStay) {
  Floor floor;
  floor.set({4, 4}, CellState::kFree);
  floor.set({5, 5}, CellState::kOccupied);
  floor.set({8, 9}, CellState::kFree);
  const auto png = floor.png({Layer::kGrid, 1, 0, 0});
  ASSERT_TRUE(png);
  EXPECT_EQ(pixel(*png, 2, 255 - 2), kDark);
  EXPECT_EQ(pixel(*png, 4, 255 - 4), kWhite);
  const auto coarse = floor.png({Layer::kGrid, 8, 0, 0});
  ASSERT_TRUE(coarse);
  EXPECT_EQ(pixel(*coarse, 0, 255), kDark);
}

TEST(MapPicture, RoomsHaveTheirColours) {
  Floor floor;
  floor.set({3, 3}, CellState::kFree, 0);
  floor.set({4, 3}, CellState::kFree, 1);
  const auto png = floor.png({Layer::kRooms, 0, 0, 0});
  ASSERT_TRUE(png);
  EXPECT_EQ(pixel(*png, 3, 252), 0xbebadaff);
  EXPECT_EQ(pixel(*png, 4, 252), 0x80b1d3ff);
  EXPECT_EQ(pixel(*png, 5, 252) & 0xffU, 0U);
}

TEST(MapPicture, WhereNothingIsKnownThereIsNoPicture) {
  Floor floor;
  EXPECT_FALSE(floor.png({Layer::kGrid, 0, 0, 0}));
  floor.set({3, 3}, CellState::kFree);
  const auto shared = floor.shared();
  const MapPicture& picture = *shared;
  EXPECT_TRUE(picture.png({Layer::kGrid, 0, 0, 0}));
  EXPECT_FALSE(picture.png({Layer::kRooms, 0, 0, 0}));
  EXPECT_FALSE(picture.png({Layer::kGrid, 0, 1, 0}));
  EXPECT_FALSE(picture.png({Layer::kGrid, 9, 0, 0}));
  EXPECT_FALSE(picture.png({Layer::kGrid, 0, 4'000'000'000U, 4'000'000'000U}));
}

/// Compares every cell of a random floor with the cells themselves.
TEST(MapPicture, EachLevelJoinsTheCellsBelowIt) {
  Floor floor;
  std::vector<CellState> cells(std::size_t{100} * 70);
  unsigned state = 1;
  for (int row = 0; row < 70; ++row) {
    for (int column = 0; column < 100; ++column) {
      state = state * 1664525U + 1013904223U;
      const auto cell = static_cast<CellState>((state >> 16U) % 40 < 3 ? (state >> 16U) % 40 : 2);
      cells[static_cast<std::size_t>(row) * 100 + static_cast<std::size_t>(column)] = cell;
      floor.set({column, row}, cell);
    }
  }
  const auto shared = floor.shared();
  const MapPicture& picture = *shared;
  for (const std::uint32_t level : {0U, 1U, 2U, 3U}) {
    const auto png = picture.png({Layer::kGrid, level, 0, 0});
    ASSERT_TRUE(png);
    const int side = 1 << level;
    for (int row = 0; row * side < 70; row += 3) {
      for (int column = 0; column * side < 100; column += 7) {
        bool occupied = false;
        bool free = false;
        for (int y = row * side; y < std::min(70, (row + 1) * side); ++y) {
          for (int x = column * side; x < std::min(100, (column + 1) * side); ++x) {
            const CellState cell =
                cells[static_cast<std::size_t>(y) * 100 + static_cast<std::size_t>(x)];
            occupied |= cell == CellState::kOccupied;
            free |= cell == CellState::kFree;
          }
        }
        const std::uint32_t expected = occupied ? kDark : (free ? kWhite : kClear);
        ASSERT_EQ(
            pixel(*png, static_cast<std::uint32_t>(column), static_cast<std::uint32_t>(255 - row)),
            expected)
            << level << ": " << column << ", " << row;
      }
    }
  }
}

class Resources : public testing::Test {
 protected:
  Resources() {
    Floor floor;
    floor.set({3, 3}, CellState::kFree, 1);
    floor.set({4, 3}, CellState::kOccupied);
    map_.frame = "0123abcd";
    map_.version = 5;
    map_.rooms = {"hall", "room A"};
    map_.picture = floor.shared();
  }
  Answer tile(const std::string& path, const std::string& query = {}) {
    Request request;
    request.path = path;
    request.query = query;
    return tile_answer(request, &map_);
  }
  Answer at(const std::string& query) {
    Request request;
    request.query = query;
    return point_answer(request, &map_);
  }
  ShownMap map_;
};

TEST_F(Resources, TilesWithTheirVersionMayBeKept) {
  EXPECT_EQ(tile("/tiles/grid/0123abcd/0/0/0.png", "v=5").status, 200U);
  EXPECT_TRUE(tile("/tiles/grid/0123abcd/0/0/0.png", "v=5").cacheable);
  EXPECT_FALSE(tile("/tiles/grid/0123abcd/0/0/0.png").cacheable);
  EXPECT_EQ(tile("/tiles/grid/0123abcd/0/0/0.png").content_type, "image/png");
}

TEST_F(Resources, OtherTilesAreNotThere) {
  for (const char* path : {"/tiles/grid/ffffffff/0/0/0.png", "/tiles/walls/0123abcd/0/0/0.png",
                           "/tiles/grid/0123abcd/0/0/0.jpg", "/tiles/grid/0123abcd/0/0",
                           "/tiles/grid/0123abcd/-1/0/0.png", "/tiles/grid/0123abcd/0/9/9.png",
                           "/tiles/grid/0123abcd/0/0x/0.png", "/tiles/"}) {
    EXPECT_EQ(tile(path).status, 404U) << path;
  }
  Request request;
  request.path = "/tiles/grid/0123abcd/0/0/0.png";
  EXPECT_EQ(tile_answer(request, nullptr).status, 404U);
}

TEST_F(Resources, APointHasItsRoom) {
  EXPECT_EQ(at("x_m=0.35&y_m=0.35").body,
            R"({"inside":true,"cell":"free","reachable":true,"zone":1,"room":"room A"})");
  EXPECT_EQ(at("y_m=0.35&x_m=0.45").body, R"({"inside":true,"cell":"occupied","reachable":false})");
  EXPECT_EQ(at("x_m=-1&y_m=0").body, R"({"inside":false})");
  EXPECT_EQ(at("x_m=1").status, 400U);
  EXPECT_EQ(at("x_m=nan&y_m=1").body, R"({"inside":false})");
  EXPECT_EQ(at("x_m=a&y_m=1").status, 400U);
}

}  // namespace
}  // namespace topogeo::web
