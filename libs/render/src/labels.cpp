#include "labels.hpp"

#include <algorithm>
#include <array>

#include "canvas.hpp"

namespace topogeo::render {

void Labels::block(const Eigen::Vector2d& centre_px, double half_px) {
  taken_.push_back({centre_px.x() - half_px, centre_px.y() - half_px, 2 * half_px, 2 * half_px});
}

bool Labels::is_free(const Rect& rect) const {
  return std::ranges::none_of(taken_, [&](const Rect& other) { return rect.overlaps(other); });
}

void Labels::draw(cairo_t* cr, const std::string& text, const Eigen::Vector2d& at_px,
                  double away_px, double size_px, const Rect& within, bool always) {
  const double width = text_width_px(cr, text, size_px);
  const double height = 0.78 * size_px;
  const auto place = [&](double right, double down) {
    const double x = at_px.x() + right * away_px + 0.5 * (right - 1.0) * width;
    const double y = at_px.y() + down * away_px + 0.5 * (down - 1.0) * height;
    return Rect{x, y, width, height};
  };
  constexpr std::array<std::array<double, 2>, 8> kPlaces{
      {{1, -1}, {-1, -1}, {1, 1}, {-1, 1}, {1, 0}, {-1, 0}, {0, -1}, {0, 1}}};
  Rect chosen = place(1, -1);
  bool found = false;
  for (const auto& [right, down] : kPlaces) {
    const Rect rect = place(right, down);
    if (!rect.is_inside(within) || !is_free(rect)) continue;
    chosen = rect;
    found = true;
    break;
  }
  if (!found && !always) return;
  taken_.push_back(chosen);
  draw_text(cr, text, chosen.left, chosen.bottom(), size_px);
}

}  // namespace topogeo::render
