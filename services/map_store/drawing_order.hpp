// Effect of an order on the drawing of a map.
#pragma once

#include <optional>
#include <string>

#include "topogeo/msg/drawing.h"
#include "topogeo/storage/map_drawing.hpp"

namespace topogeo::map_store {

struct DrawingOutcome {
  msg::DrawingResult result = msg::kDrawingDone;
  std::string message;                         ///< for people: reason of a refusal
  std::optional<storage::MapDrawing> drawing;  ///< the new drawing, one version higher, when done
};

/// `now` stays unchanged. A floor becomes a grid with cells of `resolution_m`.
DrawingOutcome carry_out(const msg::DrawingOrder& order, const storage::MapDrawing& now,
                         double resolution_m);

}  // namespace topogeo::map_store
