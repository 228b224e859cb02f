#include "reproduce/macondo_arrival.hpp"

#include <string>
#include <vector>

#include "topogeo/support/format.hpp"

#include "reproduce/drawing.hpp"
#include "reproduce/macondo_drives.hpp"
#include "reproduce/worlds.hpp"

namespace topogeo::reproduce {
namespace {

using render::FigureColour;
using render::FigurePanel;

constexpr const char* kArrivalFloor = "experiment_2";
constexpr int kDrives = 200;

/// A grid of poses costs a hundred times as much as one window.
constexpr int kPoseDrives = 20;

std::vector<MacondoDrive> drive_all(const DrawnFloor& floor, const MacondoKind& kind) {
  const int count = kind.rule == PerceptionRule::kPoses ? kPoseDrives : kDrives;
  std::vector<MacondoDrive> drives;
  drives.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    drives.push_back(drive_macondo(floor, static_cast<std::uint64_t>(i) + 1, kind));
  }
  return drives;
}

struct DriveCounts {
  int drives = 0;
  int arrived = 0;
  int kept_off = 0;
  int kept_off_arrived = 0;
  int lost = 0;
  int hits = 0;
};

DriveCounts counts_of(const std::vector<MacondoDrive>& drives) {
  DriveCounts counts;
  counts.drives = static_cast<int>(drives.size());
  for (const MacondoDrive& drive : drives) {
    counts.arrived += drive.arrived() ? 1 : 0;
    counts.kept_off += drive.kept_off ? 1 : 0;
    counts.kept_off_arrived += drive.kept_off && drive.arrived() ? 1 : 0;
    counts.lost += drive.localized ? 0 : 1;
    counts.hits += drive.hit ? 1 : 0;
  }
  return counts;
}

std::vector<std::string> row_of(const char* rule, const char* wheel_errors,
                                const DriveCounts& counts) {
  return {rule,
          wheel_errors,
          std::to_string(counts.drives),
          std::to_string(counts.arrived),
          std::to_string(counts.kept_off),
          std::to_string(counts.kept_off_arrived),
          std::to_string(counts.arrived - counts.kept_off_arrived),
          std::to_string(counts.lost),
          std::to_string(counts.hits)};
}

void draw_ends(Report& report, const std::vector<MacondoDrive>& drives) {
  FigurePanel panel;
  panel.title = "where drives end, from their goals";
  panel.across = "x (m)";
  panel.up = "y (m)";
  render::FigureDots good{{}, FigureColour::kBlue, 2.5};
  render::FigureDots bad{{}, FigureColour::kRed, 2.5};
  for (const MacondoDrive& drive : drives) {
    const Eigen::Vector2d off(drive.error_x_m, drive.error_y_m);
    (drive.arrived() ? good : bad).points.push_back(off.cwiseMax(-1.0).cwiseMin(1.0));
  }
  panel.dots = {bad, good};
  panel.extent = {{-1.1, -1.1}, {1.1, 1.1}};
  add_rectangle(panel, {{-0.15, -0.15}, {0.15, 0.15}}, FigureColour::kGrey, true);
  report.draw({.title = "200 drives with six sonars, the published rule", .panels = {panel}},
              "Dashed: the cell of the goal and those beside it. Farther than 1 m: at the border.");
}

}  // namespace

void macondo_arrival(Report& report) {
  const DrawnFloor floor = draw_floor(world_named(kArrivalFloor));
  const std::vector<MacondoDrive> drives = drive_all(floor, {});
  draw_ends(report, drives);
  const DriveCounts counts = counts_of(drives);
  const DriveCounts exact = counts_of(drive_all(floor, {.wheel_errors = 0.0}));
  const DriveCounts often = counts_of(drive_all(floor, {.rule = PerceptionRule::kOften}));
  const DriveCounts often_exact =
      counts_of(drive_all(floor, {.rule = PerceptionRule::kOften, .wheel_errors = 0.0}));
  const DriveCounts product = counts_of(drive_all(floor, {.rule = PerceptionRule::kPoses}));
  const DriveCounts by_wheels = counts_of(drive_all(floor, {.rule = PerceptionRule::kNever}));
  report.made_by({"Markov localization, six sonars at nodes and the destination", 5.0, kDrives});
  const auto share = [](const DriveCounts& of) { return 100.0 * of.arrived / of.drives; };
  const char* name = "drives that end within one cell of the goal";
  report.at_least(name, share(counts), 90.0, "%");
  report.show("the same with wheels that do not err", share(exact), "%");
  report.show("the same by the wheels alone", share(by_wheels), "%");
  report.beside(name, share(often), "%", "the same, each half metre and five times at the goal");
  report.beside(
      name, share(product), "%",
      fmt::format("the product's grid of poses, each half metre, {} drives", kPoseDrives));
  report.show("drives that touched something", counts.hits);
  report.add(
      {"The same drives by each rule.",
       {"perception", "errors of the wheels", "drives", "arrived", "way back blocked once or more",
        "of these arrived", "of the others arrived", "lost", "touched something"},
       {row_of("nodes and destination, as published", "100 %", counts),
        row_of("nodes and destination, as published", "0 %", exact),
        row_of("each half metre, five times at the goal", "100 %", often),
        row_of("each half metre, five times at the goal", "0 %", often_exact),
        row_of("grid of poses, each half metre", "100 %", product),
        row_of("none", "100 %", by_wheels)}});
}

}  // namespace topogeo::reproduce
