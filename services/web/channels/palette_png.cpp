#include "channels/palette_png.hpp"

#include <memory>
#include <stdexcept>
#include <vector>

#include <png.h>

namespace topogeo::web {
namespace {

/// libpng reports errors through a function that must not return.
[[noreturn]] void fail(png_structp, png_const_charp message) {
  throw std::runtime_error(std::string("PNG: ") + message);
}
void ignore(png_structp, png_const_charp) {}

void flush(png_structp) {}

void append(png_structp png, png_bytep bytes, png_size_t size) {
  static_cast<std::string*>(png_get_io_ptr(png))
      ->append(reinterpret_cast<const char*>(bytes), size);
}

class PngWriter {
 public:
  explicit PngWriter(std::string& out)
      : png_(png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, fail, ignore)),
        info_(png_ != nullptr ? png_create_info_struct(png_) : nullptr) {
    if (info_ == nullptr) {
      png_destroy_write_struct(&png_, nullptr);
      throw std::runtime_error("PNG: no memory");
    }
    png_set_write_fn(png_, &out, append, flush);
  }
  PngWriter(const PngWriter&) = delete;
  PngWriter& operator=(const PngWriter&) = delete;
  ~PngWriter() { png_destroy_write_struct(&png_, &info_); }

  void write(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> pixels,
             std::span<const Color> colors) {
    constexpr int kDepth_bits = 4;
    png_set_IHDR(png_, info_, width, height, kDepth_bits, PNG_COLOR_TYPE_PALETTE,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    std::vector<png_color> palette;
    std::vector<png_byte> alphas;
    for (const Color& color : colors) {
      palette.push_back({color.red, color.green, color.blue});
      alphas.push_back(color.alpha);
    }
    png_set_PLTE(png_, info_, palette.data(), static_cast<int>(palette.size()));
    png_set_tRNS(png_, info_, alphas.data(), static_cast<int>(alphas.size()), nullptr);
    png_write_info(png_, info_);
    png_set_packing(png_);
    for (std::uint32_t row = 0; row < height; ++row) {
      png_write_row(png_, pixels.data() + std::size_t{row} * width);
    }
    png_write_end(png_, nullptr);
  }

 private:
  png_structp png_;
  png_infop info_;
};

}  // namespace

std::string palette_png(std::uint32_t width, std::uint32_t height,
                        std::span<const std::uint8_t> pixels, std::span<const Color> colors) {
  constexpr std::size_t kMostColors = 16;
  if (pixels.size() != std::size_t{width} * height || colors.size() > kMostColors) {
    throw std::invalid_argument("expected width x height pixels of at most 16 colours");
  }
  std::string out;
  PngWriter(out).write(width, height, pixels, colors);
  return out;
}

}  // namespace topogeo::web
