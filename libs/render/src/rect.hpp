// A rectangle on a page, pixels, y down.
#pragma once

namespace topogeo::render {

struct Rect {
  double left = 0.0;
  double top = 0.0;
  double width = 0.0;
  double height = 0.0;

  [[nodiscard]] double right() const { return left + width; }
  [[nodiscard]] double bottom() const { return top + height; }
  [[nodiscard]] bool overlaps(const Rect& other) const {
    return left < other.right() && other.left < right() && top < other.bottom() &&
           other.top < bottom();
  }
  [[nodiscard]] bool is_inside(const Rect& outer) const {
    return left >= outer.left && right() <= outer.right() && top >= outer.top &&
           bottom() <= outer.bottom();
  }
};

}  // namespace topogeo::render
