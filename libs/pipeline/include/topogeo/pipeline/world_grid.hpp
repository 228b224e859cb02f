// The occupancy grid of a world file, so that routes can be planned on a drawn floor. Whoever
// includes this links topogeo::simulation as well.
#pragma once

#include "topogeo/planning/grid_sources.hpp"
#include "topogeo/world/world.hpp"

namespace topogeo::pipeline {

/// What never changes in the world, and the parts that are there at the start; the tour and the
/// paths of people show what is inside.
inline planning::Drawing drawing_of(const world::World& world) {
  const world::World scene = world::scene_at(world, 0.0);
  planning::Drawing drawing;
  for (const world::Segment& segment : scene.segments) {
    drawing.lines.push_back({segment.a_m, segment.b_m});
  }
  for (const world::Circle& circle : scene.circles) {
    drawing.discs.push_back({circle.center_m, circle.radius_m});
  }
  drawing.inside_m = world.tour_m;
  for (const world::Person& person : world.people) {
    drawing.inside_m.insert(drawing.inside_m.end(), person.path_m.begin(), person.path_m.end());
  }
  return drawing;
}

}  // namespace topogeo::pipeline
