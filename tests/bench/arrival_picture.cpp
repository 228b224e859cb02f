#include "arrival_picture.hpp"

#include <memory>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <cairo.h>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/support/atomic_file.hpp"
#include "topogeo/support/format.hpp"

namespace topogeo::bench {
namespace {

constexpr double kScale = 40.0;  // pixels per metre
constexpr double kTitle_px = 24.0;
constexpr double kRobot_m = 0.267;

struct Colour {
  double red;
  double green;
  double blue;
};

class Canvas {
 public:
  Canvas(const planning::GridFrame& frame, const geometry::Pose2& T_map_world)
      : frame_(frame),
        T_map_world_(T_map_world),
        height_px_(frame.rows * frame.resolution_m * kScale + kTitle_px),
        surface_(
            cairo_image_surface_create(
                CAIRO_FORMAT_RGB24, static_cast<int>(frame.columns * frame.resolution_m * kScale),
                static_cast<int>(height_px_)),
            cairo_surface_destroy),
        cairo_(cairo_create(surface_.get()), cairo_destroy) {
    colour({1.0, 1.0, 1.0});
    cairo_paint(cairo_.get());
  }

  void colour(const Colour& c) { cairo_set_source_rgb(cairo_.get(), c.red, c.green, c.blue); }
  void width(double px) { cairo_set_line_width(cairo_.get(), px); }

  void cell(const planning::Cell& cell) {
    const double side_px = frame_.resolution_m * kScale;
    cairo_rectangle(cairo_.get(), cell.column * side_px, height_px_ - (cell.row + 1) * side_px,
                    side_px, side_px);
    cairo_fill(cairo_.get());
  }

  void line(const std::vector<Eigen::Vector2d>& points_m) {
    for (const Eigen::Vector2d& point_m : points_m) {
      const Eigen::Vector2d px = pixel(point_m);
      cairo_line_to(cairo_.get(), px.x(), px.y());
    }
    cairo_stroke(cairo_.get());
  }

  void circle(const Eigen::Vector2d& center_m, double radius_m) {
    const Eigen::Vector2d px = pixel(center_m);
    cairo_new_path(cairo_.get());
    cairo_arc(cairo_.get(), px.x(), px.y(), radius_m * kScale, 0.0, 2.0 * std::numbers::pi);
    cairo_stroke(cairo_.get());
  }

  void world_surfaces(const world::World& scene) {
    for (const world::Segment& segment : scene.segments) {
      line({T_map_world_ * segment.a_m, T_map_world_ * segment.b_m});
    }
    for (const world::Circle& round : scene.circles) {
      circle(T_map_world_ * round.center_m, round.radius_m);
    }
  }

  void robot(const geometry::Pose2& T_map_robot) {
    circle(T_map_robot.position_m(), kRobot_m);
    line({T_map_robot.position_m(), T_map_robot * Eigen::Vector2d(0.6, 0.0)});
  }

  void title(const std::string& text) {
    cairo_set_font_size(cairo_.get(), 14.0);
    cairo_move_to(cairo_.get(), 6.0, 17.0);
    cairo_show_text(cairo_.get(), text.c_str());
  }

  void write(const std::filesystem::path& file) {
    if (cairo_surface_write_to_png(surface_.get(), file.c_str()) != CAIRO_STATUS_SUCCESS) {
      throw std::runtime_error(file.string() + ": cannot be written");
    }
  }

 private:
  [[nodiscard]] Eigen::Vector2d pixel(const Eigen::Vector2d& point_m) const {
    const Eigen::Vector2d cells = frame_.in_cells(point_m);
    const double side_px = frame_.resolution_m * kScale;
    return {cells.x() * side_px, height_px_ - cells.y() * side_px};
  }

  const planning::GridFrame& frame_;
  geometry::Pose2 T_map_world_;
  double height_px_;
  std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> surface_;
  std::unique_ptr<cairo_t, void (*)(cairo_t*)> cairo_;
};

void draw_grid(Canvas& canvas, const planning::OccupancyGrid& grid) {
  for (std::size_t i = 0; i < grid.frame().size(); ++i) {
    const planning::Cell cell = grid.frame().cell_at(i);
    if (grid.at(cell) == planning::CellState::kFree) continue;
    const bool occupied = grid.at(cell) == planning::CellState::kOccupied;
    canvas.colour(occupied ? Colour{0.5, 0.5, 0.6} : Colour{0.88, 0.88, 0.88});
    canvas.cell(cell);
  }
}

world::World obstacle_of(const MappedFloor& floor, const ArrivalTask& task) {
  world::World world;
  for (std::size_t i = floor.world.changing.size(); i < task.world.changing.size(); ++i) {
    world.segments = task.world.changing[i].segments;
    world.circles = task.world.changing[i].circles;
  }
  return world;
}

}  // namespace

void write_arrival_picture(const std::filesystem::path& file, const MappedFloor& floor,
                           const ArrivalTask& task, const ArrivalRecord& record,
                           const std::string& title) {
  const geometry::Pose2 T_map_world = geometry::inverse(floor.T_world_map());
  Canvas canvas(floor.map->frame(), T_map_world);
  draw_grid(canvas, floor.map->space().grid());
  canvas.width(1.0);
  canvas.colour({0.0, 0.0, 0.0});
  canvas.world_surfaces(world::scene_at(floor.world, 0.0));
  canvas.width(2.5);
  canvas.colour({1.0, 0.55, 0.0});
  canvas.world_surfaces(obstacle_of(floor, task));
  canvas.width(1.5);
  canvas.colour({0.3, 0.5, 1.0});
  canvas.line(task.route_m);
  for (const auto& route_m : record.routes_m) canvas.line(route_m);
  std::vector<Eigen::Vector2d> true_path_m;
  std::vector<Eigen::Vector2d> reported_path_m;
  for (const TracePoint& point : record.trace) {
    true_path_m.push_back(T_map_world * point.T_world_robot.position_m());
    if (point.T_map_robot) reported_path_m.push_back(point.T_map_robot->position_m());
  }
  canvas.colour({0.0, 0.65, 0.2});
  canvas.line(reported_path_m);
  canvas.colour({0.9, 0.0, 0.0});
  canvas.line(true_path_m);
  if (!record.trace.empty()) canvas.robot(T_map_world * record.trace.back().T_world_robot);
  canvas.colour({0.6, 0.0, 0.7});
  canvas.robot(task.T_map_goal);
  canvas.colour({0.0, 0.0, 0.0});
  canvas.title(title);
  canvas.write(file);
}

void write_trace(const std::filesystem::path& file, const MappedFloor& floor,
                 const ArrivalRecord& record) {
  const geometry::Pose2 T_map_world = geometry::inverse(floor.T_world_map());
  std::string text =
      "time_s,true_x_m,true_y_m,true_theta_rad,x_m,y_m,theta_rad,state,reason,linear_m_per_s,"
      "angular_rad_per_s,free_ahead_m,rest_m,detours,routes,guard_stops,message\n";
  for (const TracePoint& point : record.trace) {
    const geometry::Pose2 truth = T_map_world * point.T_world_robot;
    const geometry::Pose2 told = point.T_map_robot.value_or(geometry::Pose2{});
    const navigation::NavigatorStatus& s = point.status;
    text += fmt::format(
        "{:.2f},{:.3f},{:.3f},{:.4f},{:.3f},{:.3f},{:.4f},{},{},{:.3f},{:.3f},{:.2f},{:.2f},{},{},"
        "{},\"{}\"\n",
        point.time_s, truth.x_m, truth.y_m, truth.theta_rad, told.x_m, told.y_m, told.theta_rad,
        navigation::describe(s.state), navigation::describe(s.reason), s.command.linear_m_per_s,
        s.command.angular_rad_per_s, s.free_ahead_m, s.rest_m, s.detours, s.routes, s.guard_stops,
        s.message);
  }
  support::write_file_atomically(file, text);
}

}  // namespace topogeo::bench
