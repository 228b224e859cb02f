#include "topogeo/pipeline/drawn_world.hpp"

#include <stdexcept>

#include "topogeo/planning/grid_sources.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/yaml_reader.hpp"

namespace topogeo::pipeline {

std::string drawn_world_text(std::string_view name, const storage::MapDrawing& drawing,
                             const geometry::Pose2& T_floor_start) {
  const std::vector<planning::Drawing::Line> walls = planning::open_walls(drawing.lines);
  if (walls.empty()) throw std::invalid_argument("walls: a floor needs at least one");
  std::string text =
      fmt::format("name: {}\nsegments:\n",
                  support::yaml_scalar(name.empty() ? "drawn floor" : std::string(name)));
  for (const planning::Drawing::Line& wall : walls) {
    text += fmt::format("  - [{}, {}, {}, {}]\n", wall.a_m.x(), wall.a_m.y(), wall.b_m.x(),
                        wall.b_m.y());
  }
  // A simulated robot starts at the first point of its tour and faces the second. Both must be
  // inside the floor, so the second is only just ahead.
  const Eigen::Vector2d ahead_m = T_floor_start * Eigen::Vector2d(0.1, 0.0);
  text += fmt::format("tour:\n  - [{}, {}]\n  - [{}, {}]\n", T_floor_start.x_m, T_floor_start.y_m,
                      ahead_m.x(), ahead_m.y());
  return text;
}

}  // namespace topogeo::pipeline
