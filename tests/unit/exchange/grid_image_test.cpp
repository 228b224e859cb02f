#include "topogeo/exchange/grid_image.hpp"

#include <algorithm>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>
#include <zlib.h>

#include "topogeo/exchange/read_text.hpp"
#include "topogeo/planning/grid_file.hpp"

#include "readers.hpp"
#include "sample_floor.hpp"

namespace topogeo::exchange {
namespace {

using planning::CellState;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class GridImageFiles : public ScratchTest {
 protected:
  /// Three by two cells of 0.05 m.
  static planning::OccupancyGrid small_grid() {
    planning::GridFrame frame;
    frame.columns = 3;
    frame.rows = 2;
    frame.resolution_m = 0.05;
    frame.T_map_grid = {-1.25, 2.0 / 3.0, 0.0};
    planning::OccupancyGrid grid(frame);
    grid.set({0, 0}, CellState::kFree);
    grid.set({1, 0}, CellState::kOccupied);
    grid.set({2, 1}, CellState::kFree);
    return grid;
  }

  GridImage read(const std::string& yaml, const std::string& pgm = "P2 2 2 255 254 0 205 100") {
    static_cast<void>(write("a.pgm", pgm));
    return read_grid_image(write("a.yaml", yaml));
  }
  std::string error(const std::string& yaml, const std::string& pgm = "P2 1 1 255 0") {
    return error_of([&] { read(yaml, pgm); });
  }
};

constexpr const char* kHead = "image: a.pgm\nresolution: 0.05\norigin: [-1.0, -2.0, 0.0]\n";
constexpr const char* kTail = "occupied_thresh: 0.65\nfree_thresh: 0.196\n";

TEST_F(GridImageFiles, AreReadByTheRulesOfHumbleAndJazzy) {
  write_files(grid_files(directory_ / "floor.yaml", small_grid()));
  EXPECT_EQ(run_reader({"grid", directory_ / "floor.yaml"}),
            "3 2 0.05 -1.25 0.6666666666666666\n0 100 -1 -1 -1 0\n");
}

TEST_F(GridImageFiles, ReadBackByUsAndAsDrawings) {
  write_files(grid_files(directory_ / "floor", small_grid()));
  const GridImage image = read_grid_image(directory_ / "floor.yaml");
  EXPECT_THAT(image.notes, IsEmpty());
  EXPECT_EQ(image.frame.T_map_grid, small_grid().frame().T_map_grid);
  EXPECT_TRUE(std::ranges::equal(occupancy_of(image).cells(), small_grid().cells()));
  const planning::OccupancyGrid drawn = planning::read_grid(directory_ / "floor.yaml");
  EXPECT_TRUE(std::ranges::equal(drawn.cells(), small_grid().cells()));
}

TEST_F(GridImageFiles, ATurnedGridIsSampledOnStraightAxes) {
  planning::GridFrame frame;
  frame.columns = 40;
  frame.rows = 20;
  frame.resolution_m = 0.1;
  frame.T_map_grid = {1.0, 2.0, 0.5};
  planning::OccupancyGrid turned(frame, CellState::kFree);
  for (std::int32_t column = 0; column < 40; ++column) {
    turned.set({column, 10}, CellState::kOccupied);
  }
  const planning::OccupancyGrid straight = without_turn(turned);
  EXPECT_EQ(straight.frame().T_map_grid.theta_rad, 0.0);
  std::size_t inside = 0;
  for (std::size_t i = 0; i < straight.frame().size(); ++i) {
    const planning::Cell cell = straight.frame().cell_at(i);
    const auto source = frame.cell_of(straight.frame().center_m(cell));
    EXPECT_EQ(straight.at(cell), source ? turned.at(*source) : CellState::kUnknown);
    inside += source.has_value();
  }
  EXPECT_NEAR(static_cast<double>(inside), 800.0, 30.0);
  const auto files = grid_files("f", turned);
  EXPECT_THAT(files[1].bytes, HasSubstr(", 0]\nnegate"));
}

TEST_F(GridImageFiles, TrinaryAsInTheSpecification) {
  // Bottom row first: 205, 100; top row: 254, 0.
  const GridImage image = read(std::string(kHead) + "negate: 0\n" + kTail);
  EXPECT_THAT(image.values, ElementsAre(-1, -1, 0, 100));
  EXPECT_THAT(image.notes, IsEmpty());
  EXPECT_EQ(image.mode, ImageMode::kTrinary);
}

TEST_F(GridImageFiles, NegateIsANumberOrAWord) {
  for (const char* word : {"1", "true", "True"}) {
    const GridImage image = read(std::string(kHead) + "negate: " + word + "\n" + kTail);
    EXPECT_THAT(image.values, ElementsAre(100, -1, 100, 0)) << word;
  }
  EXPECT_THAT(read(std::string(kHead) + "negate: false\n" + kTail).values,
              ElementsAre(-1, -1, 0, 100));
  EXPECT_THAT(error(std::string(kHead) + "negate: maybe\n" + kTail),
              HasSubstr("a.yaml:4: negate: expected 0, 1, true or false"));
}

TEST_F(GridImageFiles, RawPixelsAreValues) {
  const GridImage image =
      read(std::string(kHead) + "negate: 1\nmode: RAW\n" + kTail, "P2 3 1 255 0 100 101");
  EXPECT_THAT(image.values, ElementsAre(0, 100, -1));
}

TEST_F(GridImageFiles, ScaleGradesBetweenTheThresholds) {
  const std::string yaml =
      std::string(kHead) + "negate: 0\nmode: scale\noccupied_thresh: 1.0\nfree_thresh: 0.0\n";
  // 255 is free, 0 occupied, 128 is (255 - 128) / 255 = 49.8 %.
  EXPECT_THAT(read(yaml, "P2 3 1 255 255 0 128").values, ElementsAre(0, 100, 50));
}

TEST_F(GridImageFiles, UnknownKeysAndFreeUnknownsAreNoted) {
  const GridImage image =
      read(std::string(kHead) + "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.25\nfloor: 3\n");
  EXPECT_THAT(image.notes, Contains("line 7: key 'floor' is not known, ignored"));
  EXPECT_THAT(image.notes, Contains(HasSubstr("free_thresh 0.25 makes free")));
  EXPECT_THAT(image.values, ElementsAre(0, -1, 0, 100));
}

TEST_F(GridImageFiles, TheUnknownOfMapSaverStaysUnknown) {
  const std::string yaml =
      std::string(kHead) + "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.25\n";
  const std::string saved = "P2 2 2 255 254 0 205 205";
  const GridImage image = read(yaml, saved);
  EXPECT_THAT(image.values, ElementsAre(-1, -1, 0, 100));
  EXPECT_THAT(image.notes, ElementsAre(HasSubstr("pixels of 205 are unknown")));
  // A drawing has other values: its thresholds count.
  EXPECT_THAT(read(yaml, "P2 2 2 255 254 0 205 220").values, ElementsAre(0, 0, 0, 100));
  const auto read_as = [&](const std::string& pgm, Pixel205 pixel_205) {
    static_cast<void>(write("a.pgm", pgm));
    return read_grid_image(write("a.yaml", yaml), pixel_205).values;
  };
  EXPECT_THAT(read_as(saved, Pixel205::kThreshold), ElementsAre(0, 0, 0, 100));
  EXPECT_THAT(read_as("P2 2 2 255 254 0 205 220", Pixel205::kUnknown), ElementsAre(-1, 0, 0, 100));
}

TEST_F(GridImageFiles, NamesWhatIsWrong) {
  const std::string good = std::string(kHead) + "negate: 0\n" + kTail;
  EXPECT_THAT(error("resolution: 0.05\n" + std::string(kTail)), HasSubstr("a.yaml:"));
  EXPECT_THAT(error(std::string(kHead) + "negate: 0\nmode: grey\n" + kTail),
              HasSubstr("a.yaml:5: mode: expected trinary, scale or raw"));
  EXPECT_THAT(
      error("image: a.pgm\nresolution: 0.05\norigin: [0, 0]\nnegate: 0\n" + std::string(kTail)),
      HasSubstr("origin: expected [x, y, yaw]"));
  EXPECT_THAT(error(good, "P6 1 1 255 abc"),
              HasSubstr("a.pgm: no image in PGM (P2, P5), PNG or BMP"));
  EXPECT_THAT(error_of([&] { read_grid_image(directory_ / "none.yaml"); }),
              HasSubstr("none.yaml: cannot be opened"));
}

/// A PNG of eight bits a channel.
std::string png_bytes(std::uint32_t width, std::uint32_t height, std::uint32_t format,
                      const std::vector<std::uint8_t>& pixels) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = width;
  image.height = height;
  image.format = format;
  png_alloc_size_t size = 0;
  png_image_write_get_memory_size(image, size, 0, pixels.data(), 0, nullptr);
  std::string bytes(size, '\0');
  png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels.data(), 0, nullptr);
  bytes.resize(size);
  return bytes;
}

std::string little_endian(std::uint32_t value, int size) {
  std::string bytes;
  for (int i = 0; i < size; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xFFU);
  return bytes;
}

/// Rows in the order of the file, each padded to four bytes.
std::string bmp_bytes(std::int32_t width, std::int32_t height, std::uint32_t bits,
                      const std::string& palette, const std::string& rows) {
  const auto begin = static_cast<std::uint32_t>(54 + palette.size());
  return "BM" + little_endian(begin + static_cast<std::uint32_t>(rows.size()), 4) +
         little_endian(0, 4) + little_endian(begin, 4) + little_endian(40, 4) +
         little_endian(static_cast<std::uint32_t>(width), 4) +
         little_endian(static_cast<std::uint32_t>(height), 4) + little_endian(1, 2) +
         little_endian(bits, 2) + std::string(24, '\0') + palette + rows;
}

TEST_F(GridImageFiles, AHeaderWithLineEndsOfWindowsMovesNoPixel) {
  const std::string yaml = std::string(kHead) + "negate: 0\n" + kTail;
  const auto values = read(yaml).values;  // 254 0 / 205 100
  const std::string pixels("\xfe\x00\xcd\x64", 4);
  EXPECT_EQ(read(yaml, "P5\n2 2\n255\n" + pixels).values, values);
  EXPECT_EQ(read(yaml, "P5\r\n2 2\r\n255\r\n" + pixels).values, values);
  // The blank after the maximum value is \r, the first pixel is 10.
  EXPECT_EQ(read(yaml, "P5\n2 2\n255\r\n" + pixels.substr(1)).values,
            read(yaml, "P2 2 2 255 10 0 205 100").values);
}

TEST_F(GridImageFiles, PngAndBmpAreReadAsPgmIs) {
  const std::string yaml = std::string(kHead) + "negate: 0\n" + kTail;
  const GridImage pgm = read(yaml);  // 254 0 / 205 100
  EXPECT_EQ(read(yaml, png_bytes(2, 2, PNG_FORMAT_GRAY, {254, 0, 205, 100})).values, pgm.values);
  const std::vector<std::uint8_t> colours = {254, 255, 253, 0, 0, 0, 205, 205, 205, 90, 100, 110};
  EXPECT_EQ(read(yaml, png_bytes(2, 2, PNG_FORMAT_RGB, colours)).values, pgm.values);
  // Bottom row first, blue first, rows of six bytes padded to eight.
  const auto row = [](const std::vector<int>& bytes) {
    std::string text;
    for (const int byte : bytes) text += static_cast<char>(byte);
    return text;
  };
  const std::string lower = row({205, 205, 205, 110, 100, 90, 0, 0});
  const std::string upper = row({253, 255, 254, 0, 0, 0, 0, 0});
  EXPECT_EQ(read(yaml, bmp_bytes(2, 2, 24, "", lower + upper)).values, pgm.values);
  EXPECT_EQ(read(yaml, bmp_bytes(2, -2, 24, "", upper + lower)).values, pgm.values);
  std::string palette;
  for (int i = 0; i < 256; ++i) palette += row({i, i, i, 0});
  EXPECT_EQ(read(yaml, bmp_bytes(2, 2, 8, palette, row({205, 100, 0, 0, 254, 0, 0, 0}))).values,
            pgm.values);
}

/// A chunk of a PNG image.
std::string chunk(const std::string& type, const std::string& data) {
  const std::string checked = type + data;
  const auto big_endian = [](std::uint32_t value) {
    std::string bytes = little_endian(value, 4);
    std::ranges::reverse(bytes);
    return bytes;
  };
  const auto* const bytes = reinterpret_cast<const Bytef*>(checked.data());
  const auto sum = static_cast<std::uint32_t>(crc32(0, bytes, static_cast<uInt>(checked.size())));
  return big_endian(static_cast<std::uint32_t>(data.size())) + checked + big_endian(sum);
}

/// Two by two grey pixels, 254 0 / 205 100, with `depth` bits and a chunk before the pixels.
std::string grey_png(int depth, const std::string& before_pixels) {
  std::string rows;
  for (const std::vector<int>& row : {std::vector{254, 0}, std::vector{205, 100}}) {
    rows += '\0';  // no filter
    for (const int pixel : row)
      rows += std::string(static_cast<std::size_t>(depth / 8), static_cast<char>(pixel));
  }
  uLongf size = compressBound(static_cast<uLong>(rows.size()));
  std::string packed(size, '\0');
  compress(reinterpret_cast<Bytef*>(packed.data()), &size,
           reinterpret_cast<const Bytef*>(rows.data()), static_cast<uLong>(rows.size()));
  packed.resize(size);
  const std::string header =
      std::string("\0\0\0\2\0\0\0\2", 8) + static_cast<char>(depth) + std::string(4, '\0');
  return "\x89PNG\r\n\x1a\n" + chunk("IHDR", header) + before_pixels + chunk("IDAT", packed) +
         chunk("IEND", "");
}

TEST_F(GridImageFiles, PngHasItsValuesAsStored) {
  const std::string yaml = std::string(kHead) + "negate: 0\n" + kTail;
  const std::string linear = chunk("gAMA", std::string("\0\1\x86\xa0", 4));  // gamma 1
  for (const int depth : {8, 16}) {
    EXPECT_THAT(read(yaml, grey_png(depth, "")).values, ElementsAre(-1, -1, 0, 100)) << depth;
    EXPECT_THAT(read(yaml, grey_png(depth, linear)).values, ElementsAre(-1, -1, 0, 100)) << depth;
  }
}

TEST_F(GridImageFiles, NothingIsKnownWhereAnImageIsSeenThrough) {
  const std::vector<std::uint8_t> pixels = {254, 255, 254, 128, 0, 255, 0, 0};
  const std::string png = png_bytes(2, 2, PNG_FORMAT_GA, pixels);
  const std::string yaml = std::string(kHead) + "negate: 0\n" + kTail;
  EXPECT_THAT(read(yaml, png).values, ElementsAre(100, -1, 0, -1));
  EXPECT_THAT(read(yaml + "mode: scale\n", png).values, ElementsAre(100, -1, 0, -1));
}

TEST_F(GridImageFiles, ImagesThatAreDamagedOrOfOtherFormatsAreNamed) {
  const std::string yaml = std::string(kHead) + "negate: 0\n" + kTail;
  const std::string png = png_bytes(2, 2, PNG_FORMAT_GRAY, {254, 0, 205, 100});
  for (std::size_t size = 5; size < png.size() - 12; ++size) {
    EXPECT_THAT(error(yaml, png.substr(0, size)), HasSubstr("a.pgm: ")) << size;
  }
  const std::string bmp = bmp_bytes(1, 1, 24, "", std::string(4, 'x'));
  for (std::size_t size = 2; size < bmp.size() - 1; ++size) {
    EXPECT_THAT(error(yaml, bmp.substr(0, size)), HasSubstr("cut short")) << size;
  }
  EXPECT_THAT(error(yaml, bmp_bytes(1, 1, 4, "", "xxxx")), HasSubstr("4 bits"));
  EXPECT_THAT(error(yaml, bmp_bytes(30000, 1, 24, "", "xxxx")), HasSubstr("30000 x 1 pixels"));
  EXPECT_THAT(error(yaml, "GIF89a"), HasSubstr("PGM (P2, P5), PNG or BMP"));
}

}  // namespace
}  // namespace topogeo::exchange
