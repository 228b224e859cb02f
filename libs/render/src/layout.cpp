#include "layout.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "topogeo/geometry/portable_math.hpp"

namespace topogeo::render {
namespace {

// Sizes on the page, chosen by eye.
constexpr double kMargin_px = 24.0;
constexpr double kTitleHeight_px = 44.0;
constexpr double kMinWidth_px = 720.0;
constexpr double kLargestScale_px = 120.0;  // of one metre
constexpr double kQuarterTurn_rad = std::numbers::pi / 2;

struct Box {
  Eigen::Vector2d min_m = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d max_m = Eigen::Vector2d::Constant(-std::numeric_limits<double>::infinity());

  void add(const Eigen::Vector2d& p) {
    min_m = min_m.cwiseMin(p);
    max_m = max_m.cwiseMax(p);
  }
  [[nodiscard]] bool is_empty() const { return !(min_m.x() <= max_m.x()); }
  [[nodiscard]] Eigen::Vector2d size_m() const { return max_m - min_m; }
};

/// Extent in the rotated frame of everything that must be fully visible.
Box content_box(const MapPicture& picture, const std::vector<ScanOutline>& outlines,
                const Layout& turn) {
  Box box;
  for (const ScanOutline& outline : outlines) {
    for (const Eigen::Vector2d& p : outline) box.add(turn.turned_m(p));
  }
  for (const auto& pose : picture.corrected) box.add(turn.turned_m(pose.pose.position_m()));
  for (const auto& stop : picture.stops) box.add(turn.turned_m(stop.T_map_robot.position_m()));
  if (picture.global_map != nullptr) {
    for (const auto& node : picture.global_map->nodes) box.add(turn.turned_m(node.position_m));
    for (const auto& branch : picture.global_map->branches) {
      for (const auto& p : branch.points) box.add(turn.turned_m(p.position_m));
    }
  }
  return box;
}

/// Odometry may lead far away from the map: it widens the picture by at most a quarter of the map's
/// longer side in each direction and is cut off there.
void widen_for_odometry(const MapPicture& picture, const Layout& turn, Box& box) {
  Box limits;
  const double allowance_m = 0.25 * std::max(1.0, box.size_m().maxCoeff());
  limits.min_m = box.min_m.array() - allowance_m;
  limits.max_m = box.max_m.array() + allowance_m;
  for (const auto& pose : picture.odometry) {
    box.add(turn.turned_m(pose.pose.position_m()).cwiseMax(limits.min_m).cwiseMin(limits.max_m));
  }
}

void set_rotation(Layout& layout, double angle_rad) {
  const auto [sin, cos] = geometry::sincos(angle_rad);
  layout.rotation_cos = cos;
  layout.rotation_sin = sin;
}

}  // namespace

std::vector<ScanOutline> outlines_in_map(const MapPicture& picture) {
  std::vector<ScanOutline> outlines;
  for (std::size_t i = 0; i < picture.stops.size(); ++i) {
    const geometry::Pose2& T_map_robot = picture.stops[i].T_map_robot;
    const auto [sin, cos] = geometry::sincos(T_map_robot.theta_rad);
    ScanOutline outline;
    outline.reserve(picture.local_maps[i].points.size());
    for (const topomap::ScanPoint& p : picture.local_maps[i].points) {
      const double x_m = p.x_m;
      const double y_m = p.y_m;
      outline.emplace_back(T_map_robot.x_m + cos * x_m - sin * y_m,
                           T_map_robot.y_m + sin * x_m + cos * y_m);
    }
    outlines.push_back(std::move(outline));
  }
  if (!picture.walls_m.empty()) outlines.push_back(picture.walls_m);
  return outlines;
}

double dominant_wall_direction_rad(const std::vector<ScanOutline>& outlines) {
  constexpr int kBins = 180;  // half a degree
  constexpr double kBin_rad = kQuarterTurn_rad / kBins;
  constexpr std::size_t kApart = 3;   // distance in points, to reduce noise in the direction
  constexpr double kLongest_m = 0.5;  // a longer step joins different walls
  constexpr int kReach = 3;           // bins on either side that belong to the peak
  std::array<double, kBins> length_m{};
  for (const ScanOutline& outline : outlines) {
    for (std::size_t i = kApart; i < outline.size(); ++i) {
      const Eigen::Vector2d step = outline[i] - outline[i - kApart];
      const double step_m = step.norm();
      if (step_m < 1e-3 || step_m > kLongest_m) continue;
      double angle_rad = geometry::atan2(step.y(), step.x());
      while (angle_rad < 0.0) angle_rad += kQuarterTurn_rad;
      const int bin = static_cast<int>(angle_rad / kBin_rad) % kBins;
      length_m.at(static_cast<std::size_t>(bin)) += step_m;
    }
  }
  const auto at = [&](int bin) {
    return length_m.at(static_cast<std::size_t>((bin + kBins) % kBins));
  };
  double best_sum_m = 0.0;
  double best_rad = 0.0;
  for (int bin = 0; bin < kBins; ++bin) {
    double sum_m = 0.0;
    double moment = 0.0;
    for (int offset = -kReach; offset <= kReach; ++offset) {
      sum_m += at(bin + offset);
      moment += at(bin + offset) * offset;
    }
    if (sum_m > best_sum_m) {
      best_sum_m = sum_m;
      best_rad = (bin + 0.5 + moment / sum_m) * kBin_rad;
    }
  }
  if (best_rad < 0.0) best_rad += kQuarterTurn_rad;
  return best_rad < kQuarterTurn_rad ? best_rad : best_rad - kQuarterTurn_rad;
}

Layout make_layout(const MapPicture& picture, const std::vector<ScanOutline>& outlines,
                   const PictureOptions& options) {
  Layout layout;
  double rotation_rad = -dominant_wall_direction_rad(outlines);
  // The smaller of the two rotations, so that a map that was nearly level keeps its sides.
  if (rotation_rad < -0.5 * kQuarterTurn_rad) rotation_rad += kQuarterTurn_rad;
  set_rotation(layout, rotation_rad);
  Box box = content_box(picture, outlines, layout);
  if (!box.is_empty() && box.size_m().y() > 1.1 * box.size_m().x()) {
    set_rotation(layout,
                 rotation_rad + (rotation_rad > 0.0 ? -kQuarterTurn_rad : kQuarterTurn_rad));
    box = content_box(picture, outlines, layout);
  }
  if (box.is_empty()) box.add({0.0, 0.0});
  widen_for_odometry(picture, layout, box);
  constexpr double kBorder_m = 0.5;
  layout.min_m = box.min_m.array() - kBorder_m;
  layout.max_m = box.max_m.array() + kBorder_m;

  const Eigen::Vector2d size_m = layout.max_m - layout.min_m;
  const double width_px = options.max_width_px;
  const double inner_px = width_px - 2 * kMargin_px;
  layout.scale_px_per_m =
      std::min({kLargestScale_px, inner_px / size_m.x(), inner_px / size_m.y()});
  layout.map_width_px = size_m.x() * layout.scale_px_per_m;
  layout.map_height_px = size_m.y() * layout.scale_px_per_m;
  const double page_px =
      std::clamp(layout.map_width_px + 2 * kMargin_px, std::min(kMinWidth_px, width_px), width_px);
  layout.map_left_px = 0.5 * (page_px - layout.map_width_px);
  layout.map_top_px = kTitleHeight_px;
  layout.width_px = static_cast<std::uint32_t>(std::ceil(page_px - 1e-6));
  layout.height_px = static_cast<std::uint32_t>(
      std::ceil(kTitleHeight_px + layout.map_height_px + kMargin_px + kLegendHeight_px));
  return layout;
}

}  // namespace topogeo::render
