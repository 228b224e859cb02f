#include "raster_image.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>

#include <png.h>

#include "topogeo/planning/pgm_image.hpp"
#include "topogeo/support/foreign_file.hpp"
#include "topogeo/support/format.hpp"

namespace topogeo::exchange {
namespace {

constexpr std::int64_t kMostAlong = 20000;  // as a grid, see occupancy_grid.hpp
constexpr auto kMostPixels = static_cast<std::int64_t>(support::kMostPixels);
constexpr int kColours = 3;
constexpr int kOpaque = 255;

[[noreturn]] void fail_raster(const std::string& source, const std::string& what) {
  throw std::runtime_error(source + ": " + what);
}

/// Throws for a picture that is too large, before it takes memory.
void check_size(std::int64_t width, std::int64_t height, const std::string& source) {
  if (width < 1 || height < 1 || width > kMostAlong || height > kMostAlong ||
      width * height > kMostPixels) {
    fail_raster(source,
                fmt::format("{} x {} pixels, expected 1 to {} on each side, at most {} in all",
                            width, height, kMostAlong, kMostPixels));
  }
}

/// Throws if a compressed picture is longer than its pixels can be, because it would unpack for
/// minutes to useless data.
void check_packed(std::int64_t width, std::int64_t height, std::size_t bytes,
                  const std::string& source) {
  constexpr std::int64_t kPixel_bytes = 8;  // four channels of 16 bits
  constexpr std::int64_t kRow_bytes = 64;   // a filter byte, and the growth of packed noise
  constexpr std::int64_t kBeside_bytes = std::int64_t{1} << 20U;  // colour profile, texts
  const std::int64_t most = height * (width * kPixel_bytes + kRow_bytes) + kBeside_bytes;
  if (static_cast<std::int64_t>(bytes) <= most) return;
  fail_raster(source, fmt::format("{} bytes for {} x {} pixels, expected at most {}", bytes, width,
                                  height, most));
}

RasterImage blank_raster(std::int64_t width, std::int64_t height, const std::string& source) {
  check_size(width, height, source);
  RasterImage image;
  image.width = static_cast<std::int32_t>(width);
  image.height = static_cast<std::int32_t>(height);
  image.grey.resize(static_cast<std::size_t>(width * height));
  return image;
}

RasterImage raster_of_pgm(std::string_view bytes, const std::string& source) {
  const planning::PgmImage pgm = planning::parse_pgm(bytes, source);
  RasterImage image = blank_raster(pgm.width, pgm.height, source);
  image.white = pgm.depth;
  image.grey.assign(pgm.pixels.begin(), pgm.pixels.end());
  return image;
}

/// The chunks of a PNG image that say which values its pixels have. Chunks on colour, such as
/// gAMA and iCCP, are left out, because libpng would convert the values by them. A chunk that is
/// cut short stays, for libpng to refuse.
std::string pixel_chunks(std::string_view bytes) {
  constexpr std::size_t kSignature_bytes = 8;
  constexpr std::size_t kBesideData_bytes = 12;  // length, type, checksum
  constexpr std::array<std::string_view, 5> kKept = {"IHDR", "PLTE", "tRNS", "IDAT", "IEND"};
  std::string kept(bytes.substr(0, kSignature_bytes));
  for (std::size_t at = kept.size(); at < bytes.size();) {
    std::size_t size = kBesideData_bytes;
    std::uint32_t data_bytes = 0;
    for (const char byte : bytes.substr(at, 4)) {
      data_bytes = data_bytes << 8U | static_cast<unsigned char>(byte);
    }
    size = std::min(size + data_bytes, bytes.size() - at);
    const std::string_view chunk = bytes.substr(at, size);
    const std::string_view type = chunk.substr(std::min<std::size_t>(4, size), 4);
    if (type.size() < 4 || std::ranges::find(kKept, type) != kKept.end()) kept += chunk;
    at += size;
  }
  return kept;
}

RasterImage raster_of_png(std::string_view file, const std::string& source) {
  const std::string bytes = pixel_chunks(file);
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_memory(&png, bytes.data(), bytes.size()) == 0) {
    fail_raster(source, fmt::format("no PNG image: {}", static_cast<const char*>(png.message)));
  }
  // Otherwise libpng takes values of 16 bits for linear light.
  png.flags |= PNG_IMAGE_FLAG_16BIT_sRGB;
  png.format = PNG_FORMAT_RGBA;
  std::vector<png_byte> pixels;
  RasterImage image;
  try {
    image = blank_raster(png.width, png.height, source);
    check_packed(png.width, png.height, file.size(), source);
    pixels.resize(4 * image.grey.size());
  } catch (...) {
    png_image_free(&png);
    throw;
  }
  if (png_image_finish_read(&png, nullptr, pixels.data(), 0, nullptr) == 0) {
    fail_raster(source,
                fmt::format("damaged PNG image: {}", static_cast<const char*>(png.message)));
  }
  image.white = kColours * 255;
  image.see_through.resize(image.grey.size());
  for (std::size_t i = 0; i < image.grey.size(); ++i) {
    const png_byte* const pixel = &pixels[4 * i];
    image.grey[i] = static_cast<std::uint16_t>(pixel[0] + pixel[1] + pixel[2]);
    image.see_through[i] = pixel[3] == kOpaque ? 0 : 1;
  }
  return image;
}

/// Microsoft's bitmap: BITMAPINFOHEADER or a later one, uncompressed, 8 bits with a palette, 24 or
/// 32.
class BmpParser {
 public:
  BmpParser(std::string_view bytes, const std::string& source) : bytes_(bytes), source_(source) {}

  RasterImage parse() {
    constexpr std::size_t kInfoHeader = 40;
    const std::size_t begin = number(10, 4);
    const std::size_t header = number(14, 4);
    const std::int64_t width = static_cast<std::int32_t>(number(18, 4));
    const std::int64_t height = static_cast<std::int32_t>(number(22, 4));
    const std::size_t bits = number(28, 2);
    if (header < kInfoHeader) fail_raster(source_, "a BMP image of OS/2, save it as PNG");
    if (number(30, 4) != 0 || (bits != 8 && bits != 24 && bits != 32)) {
      fail_raster(source_, fmt::format("a BMP image of {} bits or compressed, expected 8, 24 or 32 "
                                       "bits, uncompressed",
                                       bits));
    }
    check_size(width, std::abs(height), source_);
    const auto columns = static_cast<std::size_t>(width);
    const auto rows = static_cast<std::size_t>(std::abs(height));
    const std::size_t stride = (columns * bits / 8 + 3) / 4 * 4;
    if (begin + (rows - 1) * stride + columns * bits / 8 > bytes_.size()) fail_short();
    RasterImage image = blank_raster(width, std::abs(height), source_);
    image.white = kColours * 255;
    const std::size_t palette = 14 + header;
    for (std::size_t row = 0; row < rows; ++row) {
      const std::size_t stored = height > 0 ? rows - 1 - row : row;
      for (std::size_t column = 0; column < columns; ++column) {
        std::size_t at = begin + stored * stride + column * bits / 8;
        if (bits == 8) at = palette + std::size_t{4} * number(at, 1);
        image.grey[row * columns + column] =
            static_cast<std::uint16_t>(number(at, 1) + number(at + 1, 1) + number(at + 2, 1));
      }
    }
    return image;
  }

 private:
  [[noreturn]] void fail_short() const { fail_raster(source_, "a BMP image that is cut short"); }

  [[nodiscard]] std::uint32_t number(std::size_t at, std::size_t size) const {
    if (at + size > bytes_.size()) fail_short();
    std::uint32_t value = 0;
    for (std::size_t i = size; i-- > 0;) {
      value = value << 8U | static_cast<unsigned char>(bytes_[at + i]);
    }
    return value;
  }

  std::string_view bytes_;
  const std::string& source_;
};

bool is_png(std::string_view start) {
  return start.starts_with("\x89PNG");
}
bool is_bmp(std::string_view start) {
  return start.starts_with("BM");
}
bool is_pgm(std::string_view start) {
  return start.starts_with("P2") || start.starts_with("P5");
}

}  // namespace

bool is_raster_image(std::string_view start) {
  return is_png(start) || is_bmp(start) || is_pgm(start);
}

RasterImage parse_raster_image(std::string_view bytes, const std::string& source) {
  if (is_png(bytes)) return raster_of_png(bytes, source);
  if (is_bmp(bytes)) return BmpParser(bytes, source).parse();
  if (is_pgm(bytes)) return raster_of_pgm(bytes, source);
  fail_raster(source, "no image in PGM (P2, P5), PNG or BMP");
}

}  // namespace topogeo::exchange
