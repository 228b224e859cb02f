// Contents of a PNG.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <cairo.h>
#include <gtest/gtest.h>

#include "canvas.hpp"
#include "rect.hpp"

namespace topogeo::render {

/// A PNG file's pixels, decoded by cairo.
class Pixels {
 public:
  explicit Pixels(std::string png) : png_(std::move(png)) {
    surface_.reset(cairo_image_surface_create_from_png_stream(read, this));
    EXPECT_EQ(cairo_surface_status(surface_.get()), CAIRO_STATUS_SUCCESS);
  }
  [[nodiscard]] int width() const { return cairo_image_surface_get_width(surface_.get()); }
  [[nodiscard]] int height() const { return cairo_image_surface_get_height(surface_.get()); }

  /// Pixels of about this colour: smoothing mixes the edges of a line with the background.
  [[nodiscard]] int count(const Colour& colour) const {
    return static_cast<int>(find(colour, {0.0, 0.0, double(width()), double(height())}).size());
  }

  /// Positions of the pixels of about this colour in a part of the picture.
  [[nodiscard]] std::vector<Eigen::Vector2d> find(const Colour& colour, const Rect& part) const {
    constexpr double kTolerance = 0.12;
    const auto is_near = [](std::uint32_t byte, double wanted) {
      return std::abs(static_cast<double>(byte & 0xffU) / 255.0 - wanted) <= kTolerance;
    };
    std::vector<Eigen::Vector2d> found;
    for (int y = static_cast<int>(part.top); y < std::min<double>(part.bottom(), height()); ++y) {
      for (int x = static_cast<int>(part.left); x < std::min<double>(part.right(), width()); ++x) {
        const std::uint32_t pixel = at(x, y);
        if (is_near(pixel >> 16U, colour.red) && is_near(pixel >> 8U, colour.green) &&
            is_near(pixel, colour.blue)) {
          found.emplace_back(x, y);
        }
      }
    }
    return found;
  }

 private:
  [[nodiscard]] std::uint32_t at(int x, int y) const {
    const unsigned char* data = cairo_image_surface_get_data(surface_.get());
    const int stride = cairo_image_surface_get_stride(surface_.get());
    std::uint32_t pixel = 0;
    std::memcpy(&pixel, data + static_cast<std::ptrdiff_t>(y) * stride + 4L * x, 4);
    return pixel & 0xffffffU;
  }
  static cairo_status_t read(void* self, unsigned char* data, unsigned int length) {
    auto* pixels = static_cast<Pixels*>(self);
    if (pixels->at_ + length > pixels->png_.size()) return CAIRO_STATUS_READ_ERROR;
    std::memcpy(data, pixels->png_.data() + pixels->at_, length);
    pixels->at_ += length;
    return CAIRO_STATUS_SUCCESS;
  }
  struct Destroy {
    void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
  };
  std::string png_;
  std::size_t at_ = 0;
  std::unique_ptr<cairo_surface_t, Destroy> surface_;
};

}  // namespace topogeo::render
