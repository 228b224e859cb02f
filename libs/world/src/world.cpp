#include "topogeo/world/world.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "topogeo/support/seed.hpp"

namespace topogeo::world {

namespace {

bool is_there(const ChangingPart& part, double driven_m, double time_s) {
  const bool by_distance = std::any_of(
      part.present.begin(), part.present.end(), [driven_m](const DistanceInterval& interval) {
        return driven_m >= interval.from_m && driven_m < interval.to_m;
      });
  const bool by_time = std::any_of(part.present_s.begin(), part.present_s.end(),
                                   [time_s](const TimeInterval& interval) {
                                     return time_s >= interval.from_s && time_s < interval.to_s;
                                   });
  return (by_distance || by_time) != part.otherwise;
}

}  // namespace

std::vector<bool> present_parts(const World& world, double driven_m, double time_s) {
  std::vector<bool> present;
  present.reserve(world.changing.size());
  for (const ChangingPart& part : world.changing)
    present.push_back(is_there(part, driven_m, time_s));
  return present;
}

World scene_at(const World& world, double driven_m, double time_s) {
  World scene{world.name, world.segments, world.circles, {}, {}, {}};
  const std::vector<bool> present = present_parts(world, driven_m, time_s);
  for (std::size_t i = 0; i < present.size(); ++i) {
    if (!present[i]) continue;
    const ChangingPart& part = world.changing[i];
    scene.segments.insert(scene.segments.end(), part.segments.begin(), part.segments.end());
    scene.circles.insert(scene.circles.end(), part.circles.begin(), part.circles.end());
  }
  return scene;
}

// The drive starts at a random point of the first two turns.
DrawnTurns::DrawnTurns(const RandomTurns& turns, std::uint64_t seed, std::size_t part)
    : turns_(turns),
      random_(support::derive_seed(seed, "changes", {part})),
      at_s_(-random_.uniform() * (turns.inside_s + turns.outside_s)) {}

TimeInterval DrawnTurns::next() {
  for (;;) {
    const TimeInterval turn{std::max(at_s_, 0.0), at_s_ + draw_s(turns_.inside_s)};
    at_s_ = turn.to_s + draw_s(turns_.outside_s);
    if (turn.to_s > 0.0) return turn;
  }
}

World draw_changes(World world, std::uint64_t seed, double until_s) {
  for (std::size_t i = 0; i < world.changing.size(); ++i) {
    ChangingPart& part = world.changing[i];
    if (!part.random) continue;
    DrawnTurns turns(*part.random, seed, i);
    for (TimeInterval turn = turns.next(); turn.from_s < until_s; turn = turns.next()) {
      part.present_s.push_back({turn.from_s, std::min(turn.to_s, until_s)});
    }
    part.random.reset();
  }
  return world;
}

double clearance_m(const World& world, const Eigen::Vector2d& point_m) {
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const Segment& segment : world.segments) {
    const Eigen::Vector2d along = segment.b_m - segment.a_m;
    const double length2 = along.squaredNorm();
    const double share =
        length2 > 0.0 ? std::clamp((point_m - segment.a_m).dot(along) / length2, 0.0, 1.0) : 0.0;
    nearest_m = std::min(nearest_m, (point_m - segment.a_m - share * along).norm());
  }
  for (const Circle& circle : world.circles) {
    const double distance_m = std::fabs((point_m - circle.center_m).norm() - circle.radius_m);
    nearest_m = std::min(nearest_m, distance_m);
  }
  return nearest_m;
}

}  // namespace topogeo::world
