#include "drawing_order.hpp"

#include <cmath>
#include <stdexcept>
#include <utility>

#include "topogeo/planning/grid_sources.hpp"
#include "topogeo/service/drawing_conversions.hpp"
#include "topogeo/support/format.hpp"

namespace topogeo::map_store {

namespace {

/// Turns walls, openings and doors into the grid.
void make_floor(storage::MapDrawing& drawing, const msg::Point2& inside, double resolution_m) {
  if (!std::isfinite(inside.x_m()) || !std::isfinite(inside.y_m())) {
    throw std::invalid_argument("inside: expected finite coordinates");
  }
  drawing.grid = planning::grid_of_floor(drawing.lines, {inside.x_m(), inside.y_m()}, resolution_m);
  service::drop_grid_lines(drawing);
}

}  // namespace

DrawingOutcome carry_out(const msg::DrawingOrder& order, const storage::MapDrawing& now,
                         double resolution_m) {
  if (order.version() != now.version) {
    return {
        msg::kDrawingOtherVersion,
        fmt::format(
            "another client saved in the meantime: version {} was edited, the current one is {}",
            order.version(), now.version),
        {}};
  }
  try {
    storage::MapDrawing drawing = service::from_msg(order.content());
    drawing.grid = now.grid;
    drawing.version = now.version + 1;
    if (order.kind() == msg::kDrawingFloor) make_floor(drawing, order.inside(), resolution_m);
    service::check_rules(drawing);
    return {msg::kDrawingDone, "", std::move(drawing)};
  } catch (const std::invalid_argument& error) {
    return {msg::kDrawingInvalid, error.what(), {}};
  }
}

}  // namespace topogeo::map_store
