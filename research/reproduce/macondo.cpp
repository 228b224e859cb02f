// MACONDO: matrices of Markov localization, virtual readings, reliability and planner.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "topogeo/markov/markov_localizer.hpp"
#include "topogeo/markov/sonar_model.hpp"
#include "topogeo/markov/transition.hpp"
#include "topogeo/planning/hybrid_planner.hpp"
#include "topogeo/render/route_picture.hpp"
#include "topogeo/simulation/sonar.hpp"
#include "topogeo/support/format.hpp"

#include "reproduce/drawing.hpp"
#include "reproduce/experiment.hpp"
#include "reproduce/macondo_arrival.hpp"
#include "reproduce/macondo_drives.hpp"
#include "reproduce/worlds.hpp"

namespace topogeo::reproduce {
namespace {

using markov::Cell;
using render::FigureColour;
using render::FigurePanel;

constexpr int kWindow = 7;
constexpr int kRows = 5;  // of the seven in the print
constexpr const char* kFloor = "experiment_2";

/// The printed state: one peak in the middle, and the peak spread by an advance.
constexpr std::array<std::array<double, 3>, 3> kPrintedAdvance{
    {{0.0, 0.0625, 0.0078}, {0.0, 0.7929, 0.0625}, {0.0, 0.0625, 0.0078}}};

double printed_state(int row, int column, bool advanced) {
  if (!advanced) return row == kRows / 2 && column == kWindow / 2 ? 1.0 : 0.0;
  const int r = row - kRows / 2 + 1;
  const int c = column - kWindow / 2 + 1;
  if (r < 0 || r > 2 || c < 0 || c > 2) return 0.0;
  return kPrintedAdvance[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)];
}

markov::BeliefGrid state(bool advanced) {
  markov::BeliefGrid grid(kWindow);
  grid.set({0, 0}, 1.0);
  if (!advanced) return grid;
  const std::vector<std::uint8_t> empty(std::size_t{kWindow} * kWindow, 0);
  const markov::ObstacleCells map(
      {.width = kWindow, .height = kWindow, .resolution_m = 0.1, .occupied = empty});
  std::vector<markov::RowBits> free;
  markov::free_cells_of_window(map, {kWindow / 2, kWindow / 2}, kWindow, free);
  markov::spread(markov::turned(markov::macondo_advance(), markov::ArrowSense::kRight, 0.0), free,
                 grid);
  return grid;
}

void add_cell(FigurePanel& panel, double x, double y, double probability) {
  const double half = 0.5;
  render::FigureLine square{
      {{x - half, y - half}, {x + half, y - half}, {x + half, y + half}, {x - half, y + half}},
      FigureColour::kGrey,
      0.75};
  square.closed = true;
  if (probability > 0.0) {
    render::FigureLine area = square;
    area.filled = true;
    area.colour = probability > 0.5 ? FigureColour::kSky : FigureColour::kPaleGrey;
    panel.lines.push_back(std::move(area));
  }
  panel.lines.push_back(std::move(square));
  panel.texts.push_back({{x, y}, fmt::format("{:g}", probability)});
}

void compare_state(Report& report, bool advanced) {
  const markov::BeliefGrid grid = state(advanced);
  FigurePanel panel;
  panel.title = advanced ? "after an advance, around the expected destination" : "at the start";
  panel.across = "along the motion (cells)";
  panel.up = "to the left (cells)";
  double worst = 0.0;
  double sum = 0.0;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kWindow; ++column) {
      const Cell at{column - kWindow / 2, kRows / 2 - row};
      add_cell(panel, at.x, at.y, grid.at(at));
      worst = std::max(worst, std::fabs(grid.at(at) - printed_state(row, column, advanced)));
      sum += grid.at(at);
    }
  }
  report.draw({.title = "State matrix", .panels = {panel}});
  report.printed("largest difference to a printed cell", worst, 0.0);
  report.show("sum of the cells", sum);
}

void macondo_figure_4(Report& report) {
  compare_state(report, false);
}

void macondo_figure_5(Report& report) {
  const std::vector<std::uint8_t> empty(std::size_t{40} * 40, 0);
  markov::MarkovLocalizer localizer(
      {},
      markov::ObstacleCells({.width = 40, .height = 40, .resolution_m = 0.1, .occupied = empty}),
      six_sonars());
  const geometry::Pose2 T_station{2.05, 2.05, 0.0};
  const std::vector<float> silent(six_sonars().size(), scan::Scan::kNoReturn);
  static_cast<void>(localizer.initialize(T_station, silent));
  const Cell before = localizer.belief().centre();
  static_cast<void>(localizer.move({markov::MoveKind::kAdvance, 0.1}));
  const Cell after = localizer.belief().centre();
  // The drawing shows the window's cells around the place of the print.
  const geometry::Pose2 T =
      geometry::Pose2{0.35, 0.25, 0.0} * geometry::between(T_station, localizer.expected());
  FigurePanel panel;
  panel.title = "the expected cell moves with the robot";
  panel.across = "x (cells)";
  panel.up = "y (cells)";
  for (int y = 0; y < kRows; ++y) {
    for (int x = 0; x < kWindow; ++x) add_cell(panel, x, y, 0.0);
  }
  panel.texts.clear();
  panel.dots.push_back({{{3.0, 2.0}}, FigureColour::kOrange, 8.0, true});
  panel.dots.push_back({{{T.x_m / 0.1 - 0.5, T.y_m / 0.1 - 0.5}}, FigureColour::kOrange, 8.0});
  panel.lines.push_back({{{3.0, 2.0}, {4.0, 2.0}}, FigureColour::kRed, 2.0});
  report.draw({.title = "An advance of one cell", .panels = {panel}});
  report.worked_out("cells that the expected position moves ahead",
                    static_cast<double>(after.x - before.x), 1.0);
  report.worked_out("cells that it moves aside", static_cast<double>(after.y - before.y), 0.0);
  const auto estimate = localizer.estimate();
  report.worked_out("cells of the most probable one from the expected one",
                    estimate ? std::fabs(estimate->offset.x) + std::fabs(estimate->offset.y) : NAN,
                    0.0);
}

void macondo_figure_6(Report& report) {
  const markov::TransitionMatrix matrix = markov::macondo_advance();
  FigurePanel panel;
  panel.title = "transition of an advance, the motion to the right";
  panel.across = "along the motion (cells)";
  panel.up = "to the left (cells)";
  double worst = 0.0;
  for (int row = 0; row < matrix.rows; ++row) {
    for (int column = 0; column < matrix.columns; ++column) {
      const double value =
          matrix.values[static_cast<std::size_t>(row) * static_cast<std::size_t>(matrix.columns) +
                        static_cast<std::size_t>(column)];
      add_cell(panel, column - 1, 1 - row, value);
      worst = std::max(worst, std::fabs(value - kPrintedAdvance[static_cast<std::size_t>(row)]
                                                               [static_cast<std::size_t>(column)]));
    }
  }
  report.draw({.title = "Transition matrix", .panels = {panel}});
  report.printed("largest difference to a printed value", worst, 0.0);
}

void macondo_figure_7(Report& report) {
  compare_state(report, true);
}

// The scene of figure 8 with the obstacles implied by its readings; the robot is _.
constexpr std::array<const char*, 11> kFigure8{
    "....#.....", "..#.......", "..........", "..........", "..........", "..___...#.",
    "..___.....", "..___...#.", "..........", "..........", "..#.#....."};

void macondo_figure_8(Report& report) {
  constexpr double kQuarter_rad = 0.5 * std::numbers::pi;
  std::vector<std::uint8_t> occupied;
  FigurePanel panel;
  panel.title = "virtual readings of six sonars (cells)";
  panel.across = "x (cells)";
  panel.up = "y (cells)";
  for (std::size_t line = kFigure8.size(); line-- > 0;) {
    const std::string row = kFigure8[line];
    for (std::size_t x = 0; x < row.size(); ++x) {
      occupied.push_back(row[x] == '#' ? 1 : 0);
      const double y = static_cast<double>(kFigure8.size() - 1 - line);
      add_cell(panel, static_cast<double>(x), y, row[x] == '#' ? 1.0 : row[x] == '_' ? 0.1 : 0.0);
    }
  }
  panel.texts.clear();
  const markov::ObstacleCells map({.width = 10,
                                   .height = static_cast<int>(kFigure8.size()),
                                   .resolution_m = 0.1,
                                   .occupied = occupied});
  const std::vector<markov::RangeSensor> sonars{{.T_robot_sensor = {0.15, 0.1, 0.0}},
                                                {.T_robot_sensor = {0.15, -0.1, 0.0}},
                                                {.T_robot_sensor = {0.1, 0.15, kQuarter_rad}},
                                                {.T_robot_sensor = {-0.1, 0.15, kQuarter_rad}},
                                                {.T_robot_sensor = {0.1, -0.15, -kQuarter_rad}},
                                                {.T_robot_sensor = {-0.1, -0.15, -kQuarter_rad}}};
  markov::SonarModel model(sonars, {});
  const geometry::Pose2 T_map_robot{0.35, 0.45, 0.0};
  model.look_around(map, T_map_robot, 5);
  constexpr std::array<double, 6> kPrinted{3, 3, 4, 3, 2, 2};
  for (std::size_t i = 0; i < sonars.size(); ++i) {
    const double cells = model.virtual_m(i, {0, 0}) / 0.1;
    report.printed(fmt::format("virtual reading of sonar {}", i + 1), cells, kPrinted[i], "cells");
    const geometry::Pose2 T = T_map_robot * sonars[i].T_robot_sensor;
    const Eigen::Vector2d end_m = T * Eigen::Vector2d(0.1 * cells, 0.0);
    const auto in_cells = [](const Eigen::Vector2d& at_m) {
      return Eigen::Vector2d(at_m.x() / 0.1 - 0.5, at_m.y() / 0.1 - 0.5);
    };
    panel.lines.push_back({{in_cells(T.position_m()), in_cells(end_m)}, FigureColour::kRed, 2.5});
    panel.texts.push_back({in_cells(0.5 * (T.position_m() + end_m)) + Eigen::Vector2d(0.3, 0.3),
                           fmt::format("{:g}", std::round(cells))});
  }
  report.draw({.title = "Virtual readings", .panels = {panel}},
              "Robot pale, obstacles blue. The drawing of the print is not in its text; this scene "
              "has the distances that it states.");
}

void macondo_reliability(Report& report) {
  constexpr int kReadings = 50;
  support::Random random(1);
  FigurePanel panel;
  panel.title = "50 readings each half metre";
  panel.across = "distance (m)";
  panel.up = "error (m)";
  panel.equal_scale = false;
  render::FigureDots dots{{}, FigureColour::kBlue, 1.5};
  int near_exact = 0;
  int near_all = 0;
  int far_off = 0;
  int far_all = 0;
  double far_worst_m = 0.0;
  for (int step = 1; step <= 9; ++step) {
    const double distance_m = 0.5 * step;
    // The first sonar faces a wall at a right angle.
    const double front_m = six_sonars().front().T_robot_sensor.x_m;
    world::World wall;
    wall.segments.push_back({{distance_m + front_m, -5.0}, {distance_m + front_m, 5.0}});
    for (int i = 0; i < kReadings; ++i) {
      const double error_m = published_readings(wall, {}, random)[0] - distance_m;
      dots.points.emplace_back(distance_m, error_m);
      const bool exact = std::fabs(error_m) <= 0.10;  // a cell
      (distance_m <= 2.5 ? near_all : far_all) += 1;
      if (distance_m <= 2.5 && exact) ++near_exact;
      if (distance_m > 2.5) {
        far_off += std::fabs(error_m) > 0.03 ? 1 : 0;
        far_worst_m = std::max(far_worst_m, std::fabs(error_m));
      }
    }
  }
  panel.dots.push_back(std::move(dots));
  report.draw({.title = "Errors of simulated sonars", .panels = {panel}});
  report.printed("readings up to 2.5 m right to a cell", 100.0 * near_exact / near_all, 100.0, "%");
  report.printed("readings from 2.5 to 5 m that are off", 100.0 * far_off / far_all, 75.0, "%");
  report.printed("largest error from 2.5 to 5 m", far_worst_m, 0.30, "m");
  const markov::SonarModelConfig config;
  report.printed("reliability up to 2.5 m", 100.0 * markov::reliability_of(config, 2.0), 100.0,
                 "%");
  report.printed("reliability from 2.5 to 5 m", 100.0 * markov::reliability_of(config, 4.0), 25.0,
                 "%");
  report.printed("reliability beyond 5 m", 100.0 * markov::reliability_of(config, 6.0), 0.0, "%");
  report.note(
      "The simulated sonars are made to err as published; what is compared is that they "
      "do, and the reliability that the model gives each reading. Off are those by more than "
      "0.03 m: of three in four that err by anything up to 0.3 m a tenth errs by less, which "
      "leaves "
      "67.5 %.");
}

void macondo_planner(Report& report) {
  const DrawnFloor floor = draw_floor(world_named(kFloor));
  const planning::HybridPlanner planner(*floor.map);
  struct Case {
    const char* name;
    planning::RouteKind kind;
  };
  for (const Case& wanted : {Case{"same zone", planning::RouteKind::kSameZone},
                             Case{"adjacent zones", planning::RouteKind::kAdjacentZones},
                             Case{"distant zones", planning::RouteKind::kDistantZones}}) {
    support::Random random(7);
    std::size_t found = 0;
    double worst = 1.0;
    bool graph_as_stated = true;
    for (int i = 0; i < 4000 && found < 10; ++i) {
      const auto pick = [&] {
        const auto size = floor.map->frame().size();
        return floor.map->frame().center_m(floor.map->frame().cell_at(std::min(
            static_cast<std::size_t>(random.uniform() * static_cast<double>(size)), size - 1)));
      };
      const Eigen::Vector2d from_m = pick();
      const Eigen::Vector2d to_m = pick();
      const planning::HybridRoute route = planner.plan(from_m, to_m);
      if (!route.found() || route.kind != wanted.kind || route.cost_m < 1.0) continue;
      const double best_m = planning::plan_on_grid(floor.map->space(), from_m, to_m).cost_m;
      worst = std::max(worst, route.cost_m / best_m);
      const bool stays = route.zones.size() == 1;
      graph_as_stated &= !stays || route.nodes.empty();
      if (wanted.kind != planning::RouteKind::kSameZone) graph_as_stated &= !route.nodes.empty();
      if (found++ == 0) {
        report.keep_picture(
            render::route_picture(*floor.map, route, wanted.name, render::PictureFormat::kPng,
                                  {.max_width_px = 900}),
            fmt::format("A route, {}", wanted.name),
            fmt::format("{}", static_cast<int>(wanted.kind)));
      }
    }
    report.states(fmt::format("{}: routes are found", wanted.name), found > 0);
    report.states(fmt::format("{}: the graph is used as stated", wanted.name), graph_as_stated);
    report.at_most(fmt::format("{}: costliest route by the cheapest on the grid", wanted.name),
                   worst, 1.0);
  }
}

}  // namespace

std::vector<Experiment> macondo() {
  const std::string kMacondo = "MACONDO";
  return {
      {"macondo-figure-4", kMacondo, "Figure 4", "State matrix when the robot's cell is known",
       macondo_figure_4},
      {"macondo-figure-5", kMacondo, "Figure 5", "An advance by one cell", macondo_figure_5},
      {"macondo-figure-6", kMacondo, "Figure 6", "Transition matrix of an advance",
       macondo_figure_6},
      {"macondo-figure-7", kMacondo, "Figure 7", "State matrix after the advance",
       macondo_figure_7},
      {"macondo-figure-8", kMacondo, "Figure 8", "Virtual readings of the six sonars",
       macondo_figure_8},
      {"macondo-reliability", kMacondo, "Part III.1, reliability",
       "Errors of sonars by distance, 50 readings each half metre, and the reliability of a "
       "reading",
       macondo_reliability},
      {"macondo-planner", kMacondo, "Part III.3, cases",
       "Routes within a zone, to the next one and to distant ones", macondo_planner, "", true},
      {"macondo-arrival", kMacondo, "Part IV, arrival",
       "Share of drives that end within one cell of their goal", macondo_arrival,
       "Wheels err here by about 4 cm a cell, as the printed matrix says, which between two nodes "
       "is more than six sonars correct, and where the way back to the route is blocked no other "
       "one is planned: the table shows the share of both",
       true},
  };
}

}  // namespace topogeo::reproduce
