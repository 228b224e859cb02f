// Texts beside marks.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>
#include <cairo.h>

#include "rect.hpp"

namespace topogeo::render {

/// Labels that avoid each other and marks.
class Labels {
 public:
  /// Blocks a square with this half side for labels.
  void block(const Eigen::Vector2d& centre_px, double half_px);
  /// Writes the text beside `at_px` at the first of eight places around it, `away_px` off, that is
  /// inside `within` and free; at the first place if none is and `always` is set.
  void draw(cairo_t* cr, const std::string& text, const Eigen::Vector2d& at_px, double away_px,
            double size_px, const Rect& within, bool always);

 private:
  [[nodiscard]] bool is_free(const Rect& rect) const;
  std::vector<Rect> taken_;
};

}  // namespace topogeo::render
