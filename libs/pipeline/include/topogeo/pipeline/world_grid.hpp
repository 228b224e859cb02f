// The occupancy grid of a world file, for planning on a drawn floor. Users must also link
// topogeo::simulation.
#pragma once

#include "topogeo/planning/grid_sources.hpp"
#include "topogeo/world/world.hpp"

namespace topogeo::pipeline {

/// The fixed parts of the world and those present at the start; the tour and the paths of people
/// show which side is inside.
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
