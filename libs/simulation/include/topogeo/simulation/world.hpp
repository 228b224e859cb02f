// A floor to drive in: everything a laser sees at its height, as segments and circles.
//
// The world file is YAML, metres, x to the right and y up in the drawing, counter-clockwise:
//   name: two rooms
//   wall_thickness: 0.1           # optional, default 0: a wall is one line
//   walls:                        # each with doors as gaps; `at` is the distance of the door's
//     - {from: [0, 0], to: [8, 0], doors: [{at: 2.5, width: 0.9}]}   # middle from `from`
//   boxes: [{from: [1, 1], to: [2, 1.5]}]        # furniture: two opposite corners
//   columns: [{center: [4, 4], radius: 0.3}]
//   segments: [[0, 0, 1, 1]]      # single lines: x1, y1, x2, y2
//   tour: [[1, 1], [6, 1]]        # way points of the drive
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace topogeo::simulation {

struct Segment {
  Eigen::Vector2d a_m;
  Eigen::Vector2d b_m;
};

struct Circle {
  Eigen::Vector2d center_m;
  double radius_m;
};

struct World {
  std::string name;
  std::vector<Segment> segments;
  std::vector<Circle> circles;
  std::vector<Eigen::Vector2d> tour_m;
};

/// Reads a world file. Throws std::runtime_error naming file, line, key and what was expected: an
/// unreadable file, broken YAML, an unknown key, a value out of range, a door outside its wall or
/// overlapping another, a world without any surface.
World load_world(const std::filesystem::path& path);

/// The same from text; `source` stands for the file in messages.
World parse_world(const std::string& text, const std::string& source);

/// Distance from a point to the nearest surface, metres; infinity in a world without surfaces.
double clearance_m(const World& world, const Eigen::Vector2d& point_m);

}  // namespace topogeo::simulation
