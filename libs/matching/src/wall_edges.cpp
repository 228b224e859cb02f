#include "wall_edges.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "principal_axes.hpp"

namespace topogeo::localization {
namespace {

using Eigen::Vector2d;

// Fixed: features depend on them, and tasks do not carry them.
constexpr double kSide_m = 0.45;  // wall used on each side of an edge: half a door
constexpr double kShortestSide_m = 0.12;
constexpr std::size_t kFewestOfSide = 4;
constexpr std::size_t kMostOnFace = 2;  // points between the two sides, on the face of the step
constexpr double kSmallestStep_m = 0.045;
constexpr double kLargestStep_m = 0.50;
constexpr double kClearStep = 4.0;         // deviations above the noise of a plain wall
constexpr double kRoughest_m = 0.03;       // deviation of the points from the two lines
constexpr double kLeastNoise_m = 0.01;     // a few points can be collinear by chance
constexpr double kWidestBetween_m = 0.25;  // between the beams beside an edge, along the wall

// Successive points of one surface.
struct Side {
  std::size_t first = 0;
  std::size_t last = 0;
  Vector2d mean_m = Vector2d::Zero();
  double xx = 0.0;  // sums of squares about the mean
  double xy = 0.0;
  double yy = 0.0;

  [[nodiscard]] double count() const { return static_cast<double>(last - first + 1); }
};

// Two parallel lines, one further back.
struct Step {
  Vector2d normal = Vector2d::Zero();  // towards the laser
  Vector2d along = Vector2d::Zero();   // from the front side to the back side
  double front_m = 0.0;                // of the lines, along the normal
  double back_m = 0.0;
  double clarity = 0.0;  // height in deviations
  std::size_t last_in_front = 0;
  std::size_t first_behind = 0;
};

struct Candidate {
  WallEdge edge;
  double clarity = 0.0;
};

class EdgeFinder {
 public:
  EdgeFinder(const std::vector<Vector2d>& points_m, const Vector2d& laser_m)
      : points_m_(points_m), laser_m_(laser_m) {}

  [[nodiscard]] std::vector<Candidate> candidates() const {
    std::vector<Candidate> found;
    for (std::size_t i = 0; i < points_m_.size(); ++i) {
      if (const std::optional<Step> step = clearest_after(i)) {
        if (const std::optional<WallEdge> edge = edge_of(*step)) {
          found.push_back({*edge, step->clarity});
        }
      }
    }
    return found;
  }

 private:
  // The clearest step whose first side ends with point i.
  [[nodiscard]] std::optional<Step> clearest_after(std::size_t i) const {
    std::optional<Step> clearest;
    const std::optional<Side> before = side(i, -1);
    if (!before) return clearest;
    const std::size_t end = std::min(points_m_.size(), i + kMostOnFace + 2);
    for (std::size_t next = i + 1; next < end; ++next) {
      if ((points_m_[next] - points_m_[i]).squaredNorm() > kLargestStep_m * kLargestStep_m) break;
      const std::optional<Side> after = side(next, +1);
      if (!after) continue;
      const std::optional<Step> step = step_between(*before, *after);
      if (step && (!clearest || step->clarity > clearest->clarity)) clearest = step;
    }
    return clearest;
  }

  // Points of one surface from `start` on, backwards (-1) or forwards (+1), up to kSide_m.
  [[nodiscard]] std::optional<Side> side(std::size_t start, int direction) const {
    const double gap_m =
        std::max(0.15, 0.07 * std::sqrt((points_m_[start] - laser_m_).squaredNorm()));
    const auto apart = [&](std::size_t a, std::size_t b, double distance_m) {
      return (points_m_[a] - points_m_[b]).squaredNorm() > distance_m * distance_m;
    };
    std::size_t end = start;
    while (direction > 0 ? end + 1 < points_m_.size() : end > 0) {
      const std::size_t next = direction > 0 ? end + 1 : end - 1;
      if (apart(next, end, gap_m) || apart(next, start, kSide_m)) break;
      end = next;
    }
    Side side{std::min(start, end), std::max(start, end)};
    if (side.last - side.first + 1 < kFewestOfSide || !apart(end, start, kShortestSide_m))
      return {};
    for (std::size_t i = side.first; i <= side.last; ++i) side.mean_m += points_m_[i];
    side.mean_m /= side.count();
    for (std::size_t i = side.first; i <= side.last; ++i) {
      const Vector2d d = points_m_[i] - side.mean_m;
      side.xx += d.x() * d.x();
      side.xy += d.x() * d.y();
      side.yy += d.y() * d.y();
    }
    return side;
  }

  // Fits both sides by principal components about their own means.
  [[nodiscard]] std::optional<Step> step_between(const Side& before, const Side& after) const {
    auto [smallest, largest, normal] =
        principal_axes(before.xx + after.xx, before.xy + after.xy, before.yy + after.yy);
    const double noise_m =
        std::max(kLeastNoise_m, std::sqrt(smallest / (before.count() + after.count() - 3.0)));
    if (noise_m > kRoughest_m) return {};
    const double length = std::sqrt(normal.squaredNorm());
    if (length <= 0.0) return {};
    normal /= normal.dot(laser_m_ - before.mean_m) < 0.0 ? -length : length;

    const Vector2d between_m = after.mean_m - before.mean_m;
    const double rise_m = normal.dot(between_m);
    const double height_m = std::fabs(rise_m);
    const bool first_in_front = rise_m < 0.0;
    Vector2d along(-normal.y(), normal.x());
    if ((along.dot(between_m) > 0.0) != first_in_front) along = -along;
    // A line turned by noise makes a step of a plain wall as well.
    const double apart_m = along.dot(between_m);
    const double sigma_m = noise_m * std::sqrt(1.0 / before.count() + 1.0 / after.count() +
                                               apart_m * apart_m / largest);
    if (height_m < kSmallestStep_m || height_m > kLargestStep_m ||
        height_m < kClearStep * sigma_m) {
      return {};
    }
    const Side& front = first_in_front ? before : after;
    const Side& back = first_in_front ? after : before;
    return Step{normal,
                along,
                normal.dot(front.mean_m),
                normal.dot(back.mean_m),
                height_m / sigma_m,
                first_in_front ? before.last : after.first,
                first_in_front ? after.first : before.last};
  }

  // Moves the border between the sides by the heights of the points, not the noise of a few: the
  // points before it fit the front, those behind it the back or the face in between.
  [[nodiscard]] bool settle_border(Step& step) const {
    constexpr std::ptrdiff_t kAround = 3;
    const std::ptrdiff_t onwards = step.first_behind > step.last_in_front ? 1 : -1;
    const auto count = static_cast<std::ptrdiff_t>(points_m_.size());
    const double half_m = 0.5 * (step.front_m - step.back_m);
    const auto of_back = [&](double height_m) {
      const double square = (height_m - step.back_m) * (height_m - step.back_m);
      return height_m > step.back_m ? std::min(square, half_m * half_m) : square;
    };
    const auto begin = static_cast<std::ptrdiff_t>(step.last_in_front) - onwards * kAround;
    const auto end = static_cast<std::ptrdiff_t>(step.first_behind) + onwards * kAround;
    double cost = 0.0;  // of all on the back; then with one more in front at a time
    double least = 0.0;
    std::ptrdiff_t border = -1;
    for (std::ptrdiff_t i = begin; i != end; i += onwards) {
      if (i < 0 || i >= count) continue;
      const double height_m = step.normal.dot(points_m_[static_cast<std::size_t>(i)]);
      cost += (height_m - step.front_m) * (height_m - step.front_m) - of_back(height_m);
      if (cost < least) {
        least = cost;
        border = i;
      }
    }
    const std::ptrdiff_t behind = border + onwards;
    if (border < 0 || behind < 0 || behind >= count) return false;
    step.last_in_front = static_cast<std::size_t>(border);
    step.first_behind = static_cast<std::size_t>(behind);
    return true;
  }

  // Position along the wall where the beam to point i meets the front line.
  [[nodiscard]] std::optional<double> meets_front_m(const Step& step, std::size_t i) const {
    const Vector2d beam_m = points_m_[i] - laser_m_;
    const double down_m = step.normal.dot(beam_m);
    if (down_m > -1e-3) return {};  // along the wall
    return step.along.dot(laser_m_ +
                          beam_m * ((step.front_m - step.normal.dot(laser_m_)) / down_m));
  }

  // The edge lies between the last beam on the front and the next one. If the laser sees the face
  // of the step, the beams end there; otherwise they pass the edge.
  [[nodiscard]] std::optional<WallEdge> edge_of(Step step) const {
    if (!settle_border(step)) return {};
    const Vector2d& front = points_m_[step.last_in_front];
    const bool sees_face = step.along.dot(front - laser_m_) < 0.0;
    std::optional<double> from_m = step.along.dot(front);
    std::optional<double> to_m = step.along.dot(points_m_[step.first_behind]);
    if (!sees_face) {
      from_m = meets_front_m(step, step.last_in_front);
      to_m = meets_front_m(step, step.first_behind);
    }
    if (!from_m || !to_m) return {};
    const double between_m = std::max(0.0, *to_m - *from_m);
    if (between_m > kWidestBetween_m) return {};
    return WallEdge{step.along * (0.5 * (*from_m + *to_m)) + step.normal * step.front_m, step.along,
                    step.front_m - step.back_m, between_m / std::sqrt(12.0)};
  }

  const std::vector<Vector2d>& points_m_;
  Vector2d laser_m_;
};

}  // namespace

std::vector<WallEdge> find_wall_edges(const std::vector<Vector2d>& points_m,
                                      const Vector2d& laser_m) {
  const std::vector<Candidate> found = EdgeFinder(points_m, laser_m).candidates();
  const auto told_better = [&](std::size_t i, std::size_t other) {
    return (found[other].edge.position_m - found[i].edge.position_m).squaredNorm() <
               kSide_m * kSide_m &&
           (found[other].clarity > found[i].clarity ||
            (found[other].clarity == found[i].clarity && other < i));
  };
  std::vector<WallEdge> edges;
  for (std::size_t i = 0; i < found.size(); ++i) {
    bool clearest = true;  // of the edges that share points with it
    for (std::size_t k = 0; k < found.size() && clearest; ++k) {
      clearest = k == i || !told_better(i, k);
    }
    if (clearest) edges.push_back(found[i].edge);
  }
  return edges;
}

}  // namespace topogeo::localization
