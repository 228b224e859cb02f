#include "arc_paths.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string_view>

#include "topogeo/geometry/portable_math.hpp"

namespace topogeo::planning {
namespace {

constexpr double kHalfTurn_rad = std::numbers::pi;
constexpr double kQuarter_rad = 0.5 * std::numbers::pi;
constexpr double kWordRounding = 1e-9;

/// The goal as the robot at the start sees it, in units of the radius.
struct Aim {
  double x;
  double y;
  double turn_rad;
};

/// Lengths of the pieces of a word that are not fixed, in units of the radius; negative: back.
struct Lengths {
  double t;
  double u;
  double v;
};
using Solution = std::optional<Lengths>;

struct Polar {
  double r;
  double angle_rad;
};

Polar polar(double x, double y) {
  return {std::sqrt(x * x + y * y), geometry::atan2(y, x)};
}

double wrapped(double angle_rad) {
  return geometry::wrap_angle(angle_rad);
}

double arc_cosine(double cosine) {
  return geometry::atan2(std::sqrt(std::max(0.0, 1.0 - cosine * cosine)), cosine);
}

// The goal seen from the middle of the first left circle, for words that end on a left circle ...
Aim from_left_to_left(const Aim& aim) {
  const geometry::SinCos turn = geometry::sincos(aim.turn_rad);
  return {aim.x - turn.sin, aim.y - 1.0 + turn.cos, aim.turn_rad};
}

// ... and on a right one.
Aim from_left_to_right(const Aim& aim) {
  const geometry::SinCos turn = geometry::sincos(aim.turn_rad);
  return {aim.x + turn.sin, aim.y - 1.0 - turn.cos, aim.turn_rad};
}

Solution left_straight_left(const Aim& aim) {
  const Aim seen = from_left_to_left(aim);
  const auto [u, t] = polar(seen.x, seen.y);
  const double v = wrapped(aim.turn_rad - t);
  if (t < -kWordRounding || v < -kWordRounding) return std::nullopt;
  return Lengths{t, u, v};
}

Solution left_straight_right(const Aim& aim) {
  const Aim seen = from_left_to_right(aim);
  const auto [apart, angle_rad] = polar(seen.x, seen.y);
  if (apart < 2.0) return std::nullopt;
  const double u = std::sqrt(apart * apart - 4.0);
  const double t = wrapped(angle_rad + geometry::atan2(2.0, u));
  const double v = wrapped(t - aim.turn_rad);
  if (t < -kWordRounding || v < -kWordRounding) return std::nullopt;
  return Lengths{t, u, v};
}

Solution left_right_left(const Aim& aim) {
  const Aim seen = from_left_to_left(aim);
  const auto [apart, angle_rad] = polar(seen.x, seen.y);
  if (apart > 4.0) return std::nullopt;
  const double u = -2.0 * (kQuarter_rad - arc_cosine(0.25 * apart));
  const double t = wrapped(angle_rad + 0.5 * u + kHalfTurn_rad);
  const double v = wrapped(aim.turn_rad - t + u);
  if (t < -kWordRounding || u > kWordRounding) return std::nullopt;
  return Lengths{t, u, v};
}

// First and last piece of four arcs, of which the middle ones are `u` and `v` long.
Lengths outer_arcs(double u, double v, const Aim& seen) {
  const double between_rad = wrapped(u - v);
  const geometry::SinCos first = geometry::sincos(u);
  const geometry::SinCos both = geometry::sincos(between_rad);
  const double a = first.sin - both.sin;
  const double b = first.cos - both.cos - 1.0;
  const double angle_rad = geometry::atan2(seen.y * a - seen.x * b, seen.x * a + seen.y * b);
  const double side = 2.0 * (both.cos - geometry::sincos(v).cos - first.cos) + 3.0;
  const double t = side < 0.0 ? wrapped(angle_rad + kHalfTurn_rad) : wrapped(angle_rad);
  return {t, u, wrapped(t - u + v - seen.turn_rad)};
}

Solution four_arcs_one_way(const Aim& aim) {
  const Aim seen = from_left_to_right(aim);
  const double cosine = 0.25 * (2.0 + std::sqrt(seen.x * seen.x + seen.y * seen.y));
  if (cosine > 1.0) return std::nullopt;
  const double u = arc_cosine(cosine);
  const Lengths found = outer_arcs(u, -u, seen);
  if (found.t < -kWordRounding || found.v > kWordRounding) return std::nullopt;
  return found;
}

Solution four_arcs_other_way(const Aim& aim) {
  const Aim seen = from_left_to_right(aim);
  const double cosine = (20.0 - seen.x * seen.x - seen.y * seen.y) / 16.0;
  if (cosine < 0.0 || cosine > 1.0) return std::nullopt;
  const double u = -arc_cosine(cosine);
  const Lengths found = outer_arcs(u, u, seen);
  if (found.t < -kWordRounding || found.v < -kWordRounding) return std::nullopt;
  return found;
}

Solution left_right_straight_left(const Aim& aim) {
  const Aim seen = from_left_to_left(aim);
  const auto [apart, angle_rad] = polar(seen.x, seen.y);
  if (apart < 2.0) return std::nullopt;
  const double r = std::sqrt(apart * apart - 4.0);
  const double u = 2.0 - r;
  const double t = wrapped(angle_rad + geometry::atan2(r, -2.0));
  const double v = wrapped(aim.turn_rad - kQuarter_rad - t);
  if (t < -kWordRounding || u > kWordRounding || v > kWordRounding) return std::nullopt;
  return Lengths{t, u, v};
}

Solution left_right_straight_right(const Aim& aim) {
  const Aim seen = from_left_to_right(aim);
  const auto [apart, angle_rad] = polar(-seen.y, seen.x);
  if (apart < 2.0) return std::nullopt;
  const double t = angle_rad;
  const double u = 2.0 - apart;
  const double v = wrapped(t + kQuarter_rad - aim.turn_rad);
  if (t < -kWordRounding || u > kWordRounding || v > kWordRounding) return std::nullopt;
  return Lengths{t, u, v};
}

Solution five_pieces(const Aim& aim) {
  const Aim seen = from_left_to_right(aim);
  const double apart = std::sqrt(seen.x * seen.x + seen.y * seen.y);
  if (apart < 2.0) return std::nullopt;
  const double u = 4.0 - std::sqrt(apart * apart - 4.0);
  if (u > kWordRounding) return std::nullopt;
  const double t = wrapped(
      geometry::atan2((4.0 - u) * seen.x - 2.0 * seen.y, -2.0 * seen.x + (u - 4.0) * seen.y));
  const double v = wrapped(t - aim.turn_rad);
  if (t < -kWordRounding || v < -kWordRounding) return std::nullopt;
  return Lengths{t, u, v};
}

enum class Part { kT, kU, kMinusU, kV, kQuarterBack };

struct Family {
  Solution (*solve)(const Aim&);
  std::string_view turns;  // L left, S straight, R right
  std::array<Part, 5> parts;
  bool from_goal;  // solved for the way back from the goal
};

constexpr auto kT = Part::kT;
constexpr auto kU = Part::kU;
constexpr auto kV = Part::kV;
constexpr auto kQuarterBack = Part::kQuarterBack;
constexpr std::array<Family, 11> kFamilies{{
    {left_straight_left, "LSL", {kT, kU, kV}, false},
    {left_straight_right, "LSR", {kT, kU, kV}, false},
    {left_right_left, "LRL", {kT, kU, kV}, false},
    {left_right_left, "LRL", {kV, kU, kT}, true},
    {four_arcs_one_way, "LRLR", {kT, kU, Part::kMinusU, kV}, false},
    {four_arcs_other_way, "LRLR", {kT, kU, kU, kV}, false},
    {left_right_straight_left, "LRSL", {kT, kQuarterBack, kU, kV}, false},
    {left_right_straight_right, "LRSR", {kT, kQuarterBack, kU, kV}, false},
    {left_right_straight_left, "LSRL", {kV, kU, kQuarterBack, kT}, true},
    {left_right_straight_right, "RSRL", {kV, kU, kQuarterBack, kT}, true},
    {five_pieces, "LRSLR", {kT, kQuarterBack, kU, kQuarterBack, kV}, false},
}};

double length_of(Part part, const Lengths& lengths) {
  switch (part) {
    case Part::kT:
      return lengths.t;
    case Part::kU:
      return lengths.u;
    case Part::kMinusU:
      return -lengths.u;
    case Part::kV:
      return lengths.v;
    case Part::kQuarterBack:
      return -kQuarter_rad;
  }
  return 0.0;
}

Aim aim_of(const geometry::Pose2& from, const geometry::Pose2& to, double radius_m) {
  const geometry::Pose2 seen = geometry::between(from, to);
  return {seen.x_m / radius_m, seen.y_m / radius_m, seen.theta_rad};
}

/// Calls visit(family, lengths, ahead, left) for each word: `ahead` and `left` are 1, or -1 where
/// the word is driven in the other direction or with the other turns.
template <typename Visit>
void visit_words(const Aim& aim, Visit&& visit) {
  const geometry::SinCos turn = geometry::sincos(aim.turn_rad);
  const Aim reversed{aim.x * turn.cos + aim.y * turn.sin, aim.x * turn.sin - aim.y * turn.cos,
                     aim.turn_rad};
  for (const Family& family : kFamilies) {
    const Aim& base = family.from_goal ? reversed : aim;
    for (const double ahead : {1.0, -1.0}) {
      for (const double left : {1.0, -1.0}) {
        const Solution found =
            family.solve({ahead * base.x, left * base.y, ahead * left * base.turn_rad});
        if (found) visit(family, *found, ahead, left);
      }
    }
  }
}

}  // namespace

geometry::Pose2 after(const geometry::Pose2& T_map_robot, const ArcPiece& piece) {
  const double turn_rad = piece.curvature_per_m * piece.length_m;
  const geometry::SinCos half = geometry::sincos(T_map_robot.theta_rad + 0.5 * turn_rad);
  constexpr double kStraight_rad = 1e-9;
  const double chord_m =
      std::fabs(turn_rad) < kStraight_rad
          ? piece.length_m
          : piece.length_m * geometry::sincos(0.5 * turn_rad).sin / (0.5 * turn_rad);
  return {T_map_robot.x_m + chord_m * half.cos, T_map_robot.y_m + chord_m * half.sin,
          geometry::wrap_angle(T_map_robot.theta_rad + turn_rad)};
}

std::vector<ArcPath> arc_paths(const geometry::Pose2& from, const geometry::Pose2& to,
                               double radius_m) {
  constexpr double kNoPiece = 1e-6;
  std::vector<ArcPath> paths;
  visit_words(aim_of(from, to, radius_m),
              [&](const Family& family, const Lengths& lengths, double ahead, double left) {
                ArcPath path;
                for (std::size_t i = 0; i < family.turns.size(); ++i) {
                  const double length = ahead * length_of(family.parts.at(i), lengths);
                  if (std::fabs(length) < kNoPiece) continue;
                  const char turn = family.turns[i];
                  const double side = turn == 'S' ? 0.0 : turn == 'L' ? left : -left;
                  path.push_back({length * radius_m, side / radius_m});
                }
                if (!path.empty()) paths.push_back(std::move(path));
              });
  return paths;
}

double shortest_arcs_m(const geometry::Pose2& from, const geometry::Pose2& to, double radius_m) {
  double least = std::numeric_limits<double>::infinity();
  visit_words(aim_of(from, to, radius_m),
              [&](const Family& family, const Lengths& lengths, double, double) {
                double sum = 0.0;
                for (std::size_t i = 0; i < family.turns.size(); ++i) {
                  sum += std::fabs(length_of(family.parts.at(i), lengths));
                }
                least = std::min(least, sum);
              });
  return least * radius_m;
}

}  // namespace topogeo::planning
