// Thesis, 8.1 and 8.3: times, and a floor with a loop.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/format.hpp"

#include "reproduce/chapter8.hpp"
#include "reproduce/drawing.hpp"

namespace topogeo::reproduce {

using geometry::Pose2;
using render::FigureColour;
using render::FigurePanel;

FigurePanel readings_panel(const Drive& drive, const std::string& title, bool truth) {
  FigurePanel panel;
  panel.title = title;
  const std::vector<Pose2>& poses = truth ? drive.truth : drive.odometry;
  for (std::size_t k = 0; k < drive.stops.size(); ++k) {
    add_points(panel, *drive.stops[k], poses[k], FigureColour::kGrey, 0.8);
  }
  add_path(panel, poses, FigureColour::kRed);
  return panel;
}

FigurePanel maps_panel(const Drive& drive, const std::vector<Pose2>& poses, std::size_t count,
                       const std::string& title) {
  FigurePanel panel;
  panel.title = title;
  const std::size_t shown = std::min(count, poses.size());
  for (std::size_t k = 0; k < shown; ++k) {
    add_map(panel, *drive.stops[k], poses[k], FigureColour::kSky);
  }
  add_path(panel, {poses.begin(), poses.begin() + static_cast<std::ptrdiff_t>(shown)},
           FigureColour::kRed);
  return panel;
}

namespace {

constexpr const char* kLoop = "loop";

constexpr const char* kProductLoop = "loop, 10 m";
constexpr double kDegrees = 180.0 / std::numbers::pi;

/// The first stop at which a backward correction moves the earlier ones, the next two, and the last
/// one. Without any, the last four.
std::size_t closing_stop(const Correction& correction, std::size_t stage) {
  const std::size_t last = correction.closed.size() - 1;
  if (stage == 3) return last;
  const auto at = std::ranges::find(correction.closed, true);
  if (at == correction.closed.end()) return last - 3 + stage;
  return std::min(static_cast<std::size_t>(at - correction.closed.begin()) + stage, last);
}

/// The stop at the place of published position 62.
std::size_t published_end(const Drive& drive) {
  const Eigen::Vector2d end_m(-0.4, 13.8);  // of the world
  const auto away_m = [&](const Pose2& pose) {
    return (drive.T_world_first * pose.position_m() - end_m).norm();
  };
  const auto half = static_cast<std::ptrdiff_t>(drive.truth.size() / 2);
  const auto at =
      std::ranges::min_element(drive.truth.begin() + half, drive.truth.end(), {}, away_m);
  return static_cast<std::size_t>(at - drive.truth.begin());
}

void figure_8_13(Report& report) {
  const Drive& drive = report.runs().drive(kLoop);
  report.made_by(means_of(drive));
  report.draw({.title = "Readings where odometry has the robot",
               .panels = {readings_panel(drive, "by odometry", false),
                          readings_panel(drive, "in truth", true)}});
  const std::size_t end = published_end(drive);
  const Eigen::Vector3d off = geometry::difference(drive.odometry[end], drive.truth[end]);
  report.printed("stops up to the last published position", static_cast<double>(end + 1), 62);
  report.printed("odometry off there", off.head<2>().norm(), 8.5, "m");
  report.printed("heading off there", std::fabs(off.z()) * 180.0 / std::numbers::pi, 17.0,
                 "degrees");
  report.note(
      "Published: odometry (-3.93, 21.57, -2.83) at position 62, corrected to (-0.41, "
      "13.8, -3.1). The replica is made to err as much.");
}

void figure_8_14(Report& report) {
  const Drive& drive = report.runs().drive(kLoop);
  report.made_by(means_of(drive));
  report.draw({.title = "Local maps where odometry has the robot",
               .panels = {maps_panel(drive, drive.odometry, drive.stops.size(), "by odometry"),
                          maps_panel(drive, drive.truth, drive.stops.size(), "in truth")}});
  report.states("by odometry the loop does not close (more than 5 m)",
                pose_errors(drive.odometry, drive.truth).last_m > 5.0);
}

std::string pose_as_text(const Pose2& T) {
  return fmt::format("({:.2f}, {:.2f}, {:.3f})", -T.y_m, T.x_m, T.theta_rad);
}

/// The published move of a position: by the backward correction from the forward one.
struct PublishedMove {
  double moved_m;
  double turned_degrees;
};

/// Figures 8.15, 8.17, 8.19, 8.21: positions 59 to 62 by the forward correction alone.
template <int Position>
void forward_stage(Report& report) {
  const Drive& drive = report.runs().drive(kLoop);
  const std::size_t stop = published_end(drive) - static_cast<std::size_t>(62 - Position);
  const Correction& correction = report.runs().correction(kLoop, kForwardAlone);
  report.made_by(means_of(drive, correction));
  const auto& poses = correction.poses_after[stop];
  report.draw({.title = fmt::format("Position {} by the forward correction alone", stop + 1),
               .panels = {maps_panel(drive, poses, stop + 1, "corrected positions"),
                          maps_panel(drive, drive.truth, stop + 1, "in truth")}});
  const Eigen::Vector3d off = geometry::difference(poses[stop], drive.truth[stop]);
  const Eigen::Vector3d odometry_off =
      geometry::difference(drive.odometry[stop], drive.truth[stop]);
  report.show("position", static_cast<double>(stop + 1));
  report.show("error by odometry", odometry_off.head<2>().norm(), "m");
  report.states("the forward correction does not close the loop (more than 1 m off)",
                off.head<2>().norm() > 1.0);
  const auto compare = [&](const PublishedMove& published) {
    report.at_most("error by the forward correction", off.head<2>().norm(), published.moved_m, "m");
    report.at_most("heading error by the forward correction", std::fabs(off.z()) * kDegrees,
                   published.turned_degrees, "degrees");
  };
  if (Position == 59) compare({7.93, 12.4});
  if (Position == 62) compare({5.63, 14.2});
  if (Position == 60 || Position == 61) {
    report.show("error by the forward correction", off.head<2>().norm(), "m");
    report.show("heading error by the forward correction", std::fabs(off.z()) * kDegrees,
                "degrees");
  }
  const Correction& product = report.runs().correction(kProductLoop, kProductForward);
  const Drive& farther = report.runs().drive(kProductLoop);
  const std::size_t same = published_end(farther) - static_cast<std::size_t>(62 - Position);
  report.beside(
      "error by the forward correction",
      (product.poses_after[same][same].position_m() - farther.truth[same].position_m()).norm(), "m",
      matcher_text(product.config) + ", 10 m");
  report.note(
      fmt::format("Here: odometry {}, forward {}, truth {}. Published: position 59 by odometry "
                  "(-6.1, 28.28, -2.83), forward (2, 24.43, -2.893), backward (-1.12, 16.83, "
                  "-3.047) or (-0.5, 16.9, -3.11); position 62 forward (3.69, 17.68, -2.852), "
                  "backward (-0.41, 13.8, -3.1). The truth is not known there, so the move from "
                  "forward to the nearest backward pose stands for the error.",
                  pose_as_text(drive.odometry[stop]), pose_as_text(poses[stop]),
                  pose_as_text(drive.truth[stop])));
}

/// Figures 8.16, 8.18, 8.20, 8.22: where the loop first closes, the next two positions, the last.
template <std::size_t Stage>
void backward_stage(Report& report) {
  const Drive& drive = report.runs().drive(kLoop);
  const Correction& correction = report.runs().correction(kLoop);
  report.made_by(means_of(drive, correction));
  const std::size_t stop = closing_stop(correction, Stage);
  const auto& poses = correction.poses_after[stop];
  const auto& solutions = correction.kept[stop];
  render::Figure figure;
  figure.title = solutions.empty()
                     ? fmt::format("Position {}: no backward correction closes the loop", stop + 1)
                     : fmt::format("Position {}: {} distinct solutions of the backward correction",
                                   stop + 1, solutions.size());
  figure.panels.push_back(maps_panel(drive, poses, stop + 1,
                                     solutions.empty() ? "forward positions" : "best solution"));
  FigurePanel panel;
  panel.title = "all solutions";
  for (std::size_t p = 0; p < solutions.size(); ++p) {
    add_path(panel, solutions[p], distinct_colour(p));
  }
  if (!solutions.empty()) figure.panels.push_back(std::move(panel));
  report.draw(figure);
  const Eigen::Vector3d off = geometry::difference(poses[stop], drive.truth[stop]);
  const auto& forward = report.runs().correction(kLoop, kForwardAlone).poses_after[stop];
  report.show("position", static_cast<double>(stop + 1));
  report.states("the loop is closed", !solutions.empty());
  if (Stage == 0) {
    report.at_least("distinct solutions", static_cast<double>(solutions.size()), 2);
    double moved_m = 0.0;
    for (std::size_t k = 0; k < stop; ++k) {
      moved_m = std::max(moved_m, (poses[k].position_m() - forward[k].position_m()).norm());
    }
    report.states("earlier positions are corrected, too (more than 0.5 m)", moved_m > 0.5);
    report.show("an earlier position moves by up to", moved_m, "m");
  } else {
    report.show("distinct solutions", static_cast<double>(solutions.size()));
  }
  report.at_most("error, of that of the forward correction", off.head<2>().norm(),
                 geometry::difference(forward[stop], drive.truth[stop]).head<2>().norm(), "m");
  report.show("heading error", std::fabs(off.z()) * kDegrees, "degrees");
  const std::vector<Pose2> so_far(poses.begin(),
                                  poses.begin() + static_cast<std::ptrdiff_t>(stop) + 1);
  report.show("mean error of all positions", pose_errors(so_far, drive.truth).mean_m, "m");
  if (Stage == 3) {
    const Drive& farther = report.runs().drive(kProductLoop);
    const Correction& product = report.runs().correction(kProductLoop, kProduct);
    const PoseErrors errors = pose_errors(product.final_poses(), farther.truth);
    const std::string by = matcher_text(product.config) + ", 10 m";
    report.beside("last position off", errors.last_m, "m", by);
    report.beside("mean error of all positions", errors.mean_m, "m", by);
  }
  report.note(
      fmt::format("Here {}, truth {}. Published: (-1.12, 16.83, -3.047) or (-0.5, 16.9, "
                  "-3.11) at position 59, (-0.41, 13.8, -3.1) at position 62. With 4 m of range "
                  "the replica's loop can close only after position 62, on the way to its start.",
                  pose_as_text(poses[stop]), pose_as_text(drive.truth[stop])));
}

constexpr std::size_t kLoopDrives = 20;

/// The claim of 8.3 over drives with other errors of laser and odometry.
void loop_8_3(Report& report) {
  Table table{"Where each drive ends, off the truth.",
              {"seed", "odometry (m)", "(degrees)", "forward (m)", "(degrees)", "backward (m)",
               "(degrees)"},
              {}};
  std::size_t nearer = 0;
  std::size_t close_m = 0;
  std::size_t close = 0;
  Means means;
  const double start_s = support::process_cpu_s();
  for (std::size_t seed = 1; seed <= kLoopDrives; ++seed) {
    const Drive drive = loop_drive(seed);
    const Correction correction = correct_loop(drive);
    means = means_of(drive, correction);
    const auto off = [&](const Pose2& pose) {
      const Eigen::Vector3d d = geometry::difference(pose, drive.truth.back());
      return std::pair{d.head<2>().norm(), std::fabs(d.z()) * kDegrees};
    };
    const auto odometry = off(drive.odometry.back());
    const auto forward = off(correction.map().poses().back());
    const auto backward = off(correction.final_poses().back());
    nearer += backward.first < forward.first ? 1U : 0U;
    close_m += backward.first <= 0.5 ? 1U : 0U;
    close += backward.first <= 0.5 && backward.second <= 1.0 ? 1U : 0U;
    std::vector<std::string> row{std::to_string(seed)};
    for (const auto& [m, degrees] : {odometry, forward, backward}) {
      row.push_back(fmt::format("{:.2f}", m));
      row.push_back(fmt::format("{:.1f}", degrees));
    }
    table.rows.push_back(std::move(row));
  }
  means.runs = kLoopDrives;
  report.made_by(means);
  report.printed("drives that the backward correction brings nearer to the truth",
                 static_cast<double>(nearer), static_cast<double>(kLoopDrives));
  report.show("drives that end within 0.5 m", static_cast<double>(close_m));
  report.show("drives that end within 0.5 m and 1 degree", static_cast<double>(close));
  report.show("CPU time of a drive", (support::process_cpu_s() - start_s) / kLoopDrives, "s");
  report.add(std::move(table));
  report.note(
      "Published is one drive. Each drive goes on from position 62 to its start, because 4 m of "
      "range see nothing of the first maps before.");
}

void figure_8_23(Report& report) {
  const Drive& drive = report.runs().drive("apart");
  report.made_by(means_of(drive));
  const topomap::GlobalMap map = fused(drive, drive.truth, drive.stops.size());
  FigurePanel apart = maps_panel(drive, drive.truth, drive.stops.size(), "(a) local maps");
  FigurePanel joined;
  joined.title = "(b) global map with virtual branches";
  add_map(joined, map, FigureColour::kGreen);
  report.draw({.title = "Local maps that do not overlap", .panels = {apart, joined}},
              "Virtual branches orange and dashed.");
  std::size_t without = 0;
  for (std::size_t k = 1; k < drive.stops.size(); ++k) {
    const topomap::VisibleRectangle later = topomap::seen_from(
        topomap::visible_rectangle(*drive.stops[k], false),
        geometry::between(drive.truth[k - 1], drive.truth[k]), Eigen::Vector3d::Zero());
    const auto earlier = topomap::visible_rectangle(*drive.stops[k - 1], false);
    without += topomap::overlap(later, earlier) ? 0U : 1U;
  }
  report.states("two successive local maps have nothing in common", without > 0);
  report.states("a virtual branch joins the maps",
                std::ranges::any_of(map.branches, &topomap::MapBranch::is_virtual));
  report.show("pairs of successive maps whose fields of view are apart",
              static_cast<double>(without));
  report.show("virtual branches", static_cast<double>(std::ranges::count_if(
                                      map.branches, &topomap::MapBranch::is_virtual)));
}

void times_8_1(Report& report) {
  const Drive& drive = report.runs().drive(kLoop);
  const Correction& correction = report.runs().correction(kLoop);
  report.made_by(means_of(drive, correction));
  report.at_most("local map of a scan (cells of 5 cm, range 4 m)", drive.perception_ms, 400.0,
                 "ms");
  const double matches = static_cast<double>(correction.slam->counts().tasks);
  report.show("matches of the drive", matches);
  report.at_most(
      "match of two local maps (100 individuals, 50 generations), with its share of "
      "backward corrections",
      correction.wall_s / matches, 10.0, "s");
  report.at_most("all corrections of the drive (hours there)", correction.wall_s, 7200.0, "s");
}

}  // namespace

std::vector<Experiment> chapter8_loop() {
  const std::string kThesis = "Thesis";
  std::vector<Experiment> all{
      {"times-8.1", kThesis, "Section 8.1", "Times of local maps, matches and corrections",
       times_8_1, "", true},
      {"figure-8.13", kThesis, "Figure 8.13",
       "Experiment 2, a loop: readings where odometry has the robot", figure_8_13, "", true},
      {"figure-8.14", kThesis, "Figure 8.14",
       "Experiment 2: local maps where odometry has the robot", figure_8_14, "", true}};
  const auto add = [&](int figure, const char* what, void (*run)(Report&)) {
    all.push_back({fmt::format("figure-8.{}", figure), kThesis, fmt::format("Figure 8.{}", figure),
                   fmt::format("Experiment 2: {}", what), run, "", true});
  };
  const auto add_forward = [&](int figure, int position, void (*run)(Report&)) {
    add(figure, fmt::format("position {}, forward correction alone", position).c_str(), run);
  };
  add_forward(15, 59, forward_stage<59>);
  add(16, "where the loop first closes, solutions of the backward correction", backward_stage<0>);
  add_forward(17, 60, forward_stage<60>);
  add(18, "one position on, solutions of the backward correction", backward_stage<1>);
  add_forward(19, 61, forward_stage<61>);
  add(20, "two positions on, solutions of the backward correction", backward_stage<2>);
  add_forward(21, 62, forward_stage<62>);
  add(22, "the last position, solutions of the backward correction", backward_stage<3>);
  all.push_back({"loop-8.3", kThesis, "Section 8.3",
                 "Experiment 2: the loop closed by nodes and branches alone, 20 drives", loop_8_3,
                 "", true});
  all.push_back({"figure-8.23", kThesis, "Figure 8.23",
                 "Successive local maps that do not overlap, joined by virtual branches",
                 figure_8_23, "", true});
  all.push_back({"forms-8.3", kThesis, "Section 8.3", "Experiment 2 by each form of the fitness",
                 forms_8_3, "", true});
  return all;
}

}  // namespace topogeo::reproduce
