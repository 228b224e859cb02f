#include "topogeo/render/route_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "canvas.hpp"
#include "page.hpp"

namespace topogeo::render {
namespace {

using planning::Cell;
using planning::CellState;
using planning::HybridMap;

// Sizes and colours on the page, chosen by eye.
constexpr double kRouteMargin_px = 20.0;
constexpr double kRouteHeader_px = 40.0;
constexpr Colour kFilled{0.95, 0.55, 0.10};
constexpr Colour kForbidden{0.78, 0.78, 0.78};
constexpr std::array<Colour, 6> kTints{{{0.90, 0.94, 1.00},
                                        {0.92, 0.98, 0.90},
                                        {1.00, 0.95, 0.86},
                                        {0.95, 0.91, 0.99},
                                        {0.88, 0.97, 0.97},
                                        {0.99, 0.92, 0.94}}};

// A tint for each zone that differs from its neighbours', as far as there are enough.
std::vector<std::size_t> tints_of(const HybridMap& map) {
  std::vector<std::size_t> tints(map.zones().zones.size());
  for (std::size_t zone = 0; zone < tints.size(); ++zone) {
    std::array<bool, kTints.size()> taken{};
    for (const std::uint32_t id : map.nodes_of(static_cast<planning::ZoneId>(zone))) {
      for (const planning::ZoneId other : map.nodes()[id].zones) {
        if (other < zone) taken.at(tints[other]) = true;
      }
    }
    const std::size_t wanted = zone % kTints.size();
    tints[zone] = wanted;
    for (std::size_t k = 0; k < kTints.size(); ++k) {
      const std::size_t tint = (wanted + k) % kTints.size();
      if (taken.at(tint)) continue;
      tints[zone] = tint;
      break;
    }
  }
  return tints;
}

Colour colour_of(const HybridMap& map, const std::vector<std::size_t>& tints, const Cell& cell) {
  switch (map.space().grid().at(cell)) {
    case CellState::kOccupied:
      return kInk;
    case CellState::kUnknown:
      return kWhite;
    case CellState::kFree:
      break;
  }
  const planning::ZoneId zone = map.zone_of(cell);
  return zone == planning::kNoZone ? kForbidden : kTints.at(tints[zone]);
}

class RouteDrawing {
 public:
  RouteDrawing(const HybridMap& map, double width_px)
      : map_(map),
        tints_(tints_of(map)),
        scale_((width_px - 2 * kRouteMargin_px) / map.frame().columns) {}

  [[nodiscard]] std::uint32_t height_px() const {
    return static_cast<std::uint32_t>(
        std::ceil(map_.frame().rows * scale_ + kRouteHeader_px + kRouteMargin_px));
  }

  void draw(cairo_t* cr, const planning::HybridRoute& route, const std::string& title,
            std::span<const Cell> filled, const topomap::GlobalMap* graph) const {
    start_page(cr);
    set_colour(cr, kInk);
    draw_text(cr, title, kRouteMargin_px, kRouteHeader_px - 14.0, 16.0);
    draw_cells(cr);
    set_colour(cr, kFilled);
    for (const Cell& cell : filled) {
      if (map_.frame().contains(cell)) draw_run(cr, cell, 1);
    }
    if (graph != nullptr) draw_branches(cr, *graph);
    for (const planning::BorderNode& node : map_.nodes()) {
      circle(cr, to_px(node.position_m), 2.5);
      fill_and_edge(cr, kDoor, kWhite, 0.5);
    }
    for (const planning::Place& place : map_.places()) {
      const Eigen::Vector2d at_px = to_px(place.position_m);
      set_colour(cr, kBranch);
      draw_text_centred(cr, place.name, at_px.x(), at_px.y() - 5.0, 12.0);
      if (place.station_heading_rad) draw_arrow(cr, place);
      circle(cr, at_px, 2.5);
      fill_and_edge(cr, kBranch, kWhite, 0.5);
    }
    if (route.found()) draw_route(cr, route);
  }

 private:
  [[nodiscard]] Eigen::Vector2d cells_to_px(const Eigen::Vector2d& cells) const {
    return {kRouteMargin_px + cells.x() * scale_,
            kRouteHeader_px + (map_.frame().rows - cells.y()) * scale_};
  }
  [[nodiscard]] Eigen::Vector2d to_px(const Eigen::Vector2d& point_m) const {
    return cells_to_px(map_.frame().in_cells(point_m));
  }

  // An arrow as long as a robot shows its heading on a base station.
  void draw_arrow(cairo_t* cr, const planning::Place& station) const {
    constexpr double kLength_m = 0.8;
    constexpr double kBarb_m = 0.25;
    constexpr double kBarb_rad = 2.6;
    const double heading_rad = *station.station_heading_rad;
    const auto at = [&](const Eigen::Vector2d& from_m, double length_m, double angle_rad) {
      return Eigen::Vector2d(from_m +
                             length_m * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad)));
    };
    const Eigen::Vector2d tip_m = at(station.position_m, kLength_m, heading_rad);
    set_colour(cr, kBranch);
    cairo_set_line_width(cr, 1.5);
    for (const Eigen::Vector2d& from_m :
         {station.position_m, at(tip_m, kBarb_m, heading_rad + kBarb_rad),
          at(tip_m, kBarb_m, heading_rad - kBarb_rad)}) {
      const Eigen::Vector2d from_px = to_px(from_m);
      const Eigen::Vector2d tip_px = to_px(tip_m);
      cairo_move_to(cr, from_px.x(), from_px.y());
      cairo_line_to(cr, tip_px.x(), tip_px.y());
      cairo_stroke(cr);
    }
  }

  // This many cells, from one to the right.
  void draw_run(cairo_t* cr, const Cell& first, std::int32_t cells) const {
    const Eigen::Vector2d corner_px = cells_to_px(Eigen::Vector2d(first.column, first.row + 1));
    cairo_rectangle(cr, corner_px.x(), corner_px.y(), cells * scale_, scale_);
    cairo_fill(cr);
  }

  // Draws neighbours of one colour in a row as one rectangle, to keep an SVG small.
  void draw_cells(cairo_t* cr) const {
    const auto& frame = map_.frame();
    const auto same = [](const Colour& a, const Colour& b) {
      return a.red == b.red && a.green == b.green && a.blue == b.blue;
    };
    cairo_save(cr);
    cairo_set_antialias(cr, CAIRO_ANTIALIAS_NONE);
    for (std::int32_t row = 0; row < frame.rows; ++row) {
      for (std::int32_t first = 0; first < frame.columns;) {
        const Colour colour = colour_of(map_, tints_, {first, row});
        std::int32_t end = first + 1;
        while (end < frame.columns && same(colour, colour_of(map_, tints_, {end, row}))) ++end;
        if (!same(colour, kWhite)) {
          set_colour(cr, colour);
          draw_run(cr, {first, row}, end - first);
        }
        first = end;
      }
    }
    cairo_restore(cr);
  }

  static void set_dash(cairo_t* cr, planning::PlannedOn on) {
    constexpr std::array<double, 2> kDashes{8.0, 5.0};
    constexpr std::array<double, 2> kDots{2.0, 4.0};
    if (on == planning::PlannedOn::kVirtualBranch) {
      cairo_set_dash(cr, kDashes.data(), 2, 0.0);
    } else if (on == planning::PlannedOn::kOffBranch) {
      cairo_set_dash(cr, kDots.data(), 2, 0.0);
    } else {
      cairo_set_dash(cr, nullptr, 0, 0.0);
    }
  }

  void draw_points(cairo_t* cr, const planning::HybridRoute& route, std::size_t first,
                   std::size_t last) const {
    move_to(cr, to_px(route.points_m[first]));
    for (std::size_t i = first; i <= last; ++i) line_to(cr, to_px(route.points_m[i]));
    cairo_stroke(cr);
  }

  void draw_branches(cairo_t* cr, const topomap::GlobalMap& graph) const {
    set_colour(cr, kBranch);
    cairo_set_line_width(cr, 1.0);
    for (const topomap::MapBranch& branch : graph.branches) {
      if (branch.points.empty()) continue;
      set_dash(cr, branch.is_virtual ? planning::PlannedOn::kVirtualBranch
                                     : planning::PlannedOn::kBranch);
      move_to(cr, to_px(branch.points.front().position_m));
      for (const topomap::BranchPoint& p : branch.points) line_to(cr, to_px(p.position_m));
      cairo_stroke(cr);
    }
    cairo_set_dash(cr, nullptr, 0, 0.0);
  }

  void draw_route(cairo_t* cr, const planning::HybridRoute& route) const {
    set_colour(cr, kCorrected);
    cairo_set_line_width(cr, 2.5);
    if (route.parts.empty()) draw_points(cr, route, 0, route.points_m.size() - 1);
    for (std::size_t k = 0; k < route.parts.size(); ++k) {
      const std::size_t end =
          k + 1 < route.parts.size() ? route.parts[k + 1].first_point : route.points_m.size() - 1;
      set_dash(cr, route.parts[k].on);
      draw_points(cr, route, route.parts[k].first_point, end);
    }
    cairo_set_dash(cr, nullptr, 0, 0.0);
    circle(cr, to_px(route.points_m.front()), 6.0);
    fill_and_edge(cr, kWhite, kCorrected, 2.0);
    circle(cr, to_px(route.points_m.back()), 6.0);
    fill_and_edge(cr, kCorrected, kWhite, 1.0);
  }

  const HybridMap& map_;
  std::vector<std::size_t> tints_;  // by zone
  double scale_;                    // pixels per cell
};

}  // namespace

std::string route_picture(const HybridMap& map, const planning::HybridRoute& route,
                          const std::string& title, PictureFormat format,
                          const PictureOptions& options, std::span<const Cell> filled,
                          const topomap::GlobalMap* graph) {
  check(options);
  const RouteDrawing drawing(map, options.max_width_px);
  return draw_page(format, options.max_width_px, drawing.height_px(),
                   [&](cairo_t* cr) { drawing.draw(cr, route, title, filled, graph); });
}

}  // namespace topogeo::render
