// A floor to drive on: everything a laser sees at its height, as segments and circles.
//
// The world file is YAML, metres, x to the right and y up in the drawing, counter-clockwise:
//   name: two rooms
//   wall_thickness: 0.1           # optional, default 0: a wall is one line
//   walls:                        # each with doors as gaps; `at` is the distance of the door's
//     - {from: [0, 0], to: [8, 0], doors: [{at: 2.5, width: 0.9}]}   # middle from `from`
//   boxes: [{from: [1, 1], to: [2, 1.5]}]        # furniture: two opposite corners
//   columns: [{center: [4, 4], radius: 0.3}]
//   segments: [[0, 0, 1, 1]]      # single lines: x1, y1, x2, y2
//   tour: [[1, 1], [6, 1]]        # points of the drive, in order
//   places: [{name: room A, at: [1, 1]},         # named places; each name once
//            {name: base station, at: [2, 1], heading: 1.57}]   # a base station has the heading,
//                                 # rad, of a robot that is put there
//   rooms: [{name: hall, polygon: [[0, 0], [4, 0], [4, 3]]}]   # names that people use here, to
//                                 # compare with; each name once, and where rooms overlap the
//                                 # first one counts
// Changes while the robot drives:
//   doors: [{at: 2.5, width: 0.9, open: [[0, 12.5], [40, 60]]}]   # shut except in these intervals
//                                 # of the driven distance; without `open` it always stands open
//   boxes: [{from: [1, 1], to: [2, 1.5], present: [[0, 30]]}]     # also for columns: present
//                                 # in these intervals of the driven distance only
//   open_s: [[5, 20]], present_s: [[5, 20]]   # the same in seconds since the start; a part is open
//                                 # or present when its distance or its time is in an interval
//   random: [20, 10]              # also: mean seconds open (present) and shut (absent) in turn,
//                                 # drawn from a seed (draw_changes)
//   people: [{path: [[1, 1], [6, 1]], speed: 1.2, radius: 0.2, start: 3, yields: true}]
//                                 # walk to and fro along the path, m/s (0: stand), from `start`
//                                 # seconds after the start of the drive; a person who yields waits
//                                 # until the robot has passed
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "topogeo/support/random.hpp"

namespace topogeo::world {

struct Segment {
  Eigen::Vector2d a_m;
  Eigen::Vector2d b_m;
};

struct Circle {
  Eigen::Vector2d center_m;
  double radius_m;
};

/// Driven distance, metres from the start: [from, to).
struct DistanceInterval {
  double from_m = 0.0;
  double to_m = 0.0;
};

/// Seconds since the start of the drive: [from, to).
struct TimeInterval {
  double from_s = 0.0;
  double to_s = 0.0;
};

/// Mean durations of the two alternating states; each turn lasts half to one and a half of its
/// mean.
struct RandomTurns {
  double inside_s = 0.0;   ///< present, or open for a door; > 0
  double outside_s = 0.0;  ///< absent, or shut for a door; > 0
};

/// Surfaces that are present at certain driven distances or times (a closed door, furniture that is
/// moved).
struct ChangingPart {
  std::vector<Segment> segments{};
  std::vector<Circle> circles{};
  std::vector<DistanceInterval> present{};
  bool otherwise = false;  ///< inverts `present` and `present_s`: a door that is open in these
                           ///< intervals
  std::vector<TimeInterval> present_s{};
  std::optional<RandomTurns> random{};  ///< see draw_changes
};

/// A person who walks along a path and back again.
struct Person {
  std::vector<Eigen::Vector2d> path_m{};  ///< one point: stands still
  double speed_m_per_s = 1.2;
  double radius_m = 0.2;
  double start_s = 0.0;  ///< since the start of the drive; until then at the first point
  bool yields = false;   ///< stops if the next step would be too near to the robot
};

/// A named place.
struct NamedPlace {
  std::string name;
  Eigen::Vector2d position_m;
  /// Heading of a robot that is put at this base station, [-pi, pi].
  std::optional<double> station_heading_rad{};
};

/// A room as people would outline it.
struct Room {
  std::string name;
  std::vector<Eigen::Vector2d> polygon_m;  ///< corners in order, at least three
};

struct World {
  std::string name{};
  std::vector<Segment> segments{};
  std::vector<Circle> circles{};
  std::vector<Eigen::Vector2d> tour_m{};
  std::vector<ChangingPart> changing{};
  std::vector<Person> people{};
  std::vector<NamedPlace> places{};
  std::vector<Room> rooms{};
};

/// Reads a world file. Throws std::runtime_error naming file, line, key and expectation: an
/// unreadable file, broken YAML, an unknown key, a value out of range, a door outside its wall or
/// overlapping another, a world without any surface.
World load_world(const std::filesystem::path& path);

/// The same from text; messages name `source` as the file.
World parse_world(const std::string& text, const std::string& source);

/// The surfaces that are present when the robot has driven `driven_m` and `time_s` have passed,
/// without people.
World scene_at(const World& world, double driven_m, double time_s = 0.0);

/// Tells for each of world.changing whether it is present then.
std::vector<bool> present_parts(const World& world, double driven_m, double time_s);

/// Draws the times when a random part is present or open, one after the other, without end.
class DrawnTurns {
 public:
  /// `part`: index in world.changing.
  DrawnTurns(const RandomTurns& turns, std::uint64_t seed, std::size_t part);
  /// The next interval, the first of which ends after the start of the drive.
  TimeInterval next();

 private:
  [[nodiscard]] double draw_s(double mean_s) { return mean_s * random_.uniform(0.5, 1.5); }

  RandomTurns turns_;
  support::Random random_;
  double at_s_;  // start of the next interval
};

/// The world with the times of random parts drawn up to `until_s`; before the start and after that
/// time, a random part is absent or shut.
World draw_changes(World world, std::uint64_t seed, double until_s);

/// Distance from a point to the nearest surface, metres; infinity in a world without surfaces.
/// Ignores changing parts: see scene_at.
double clearance_m(const World& world, const Eigen::Vector2d& point_m);

}  // namespace topogeo::world
