// Thesis, 8.1 and 8.3: times, and a floor with a loop.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>
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

/// The stops of the published stages, 59 to 62: the one that first closes the loop, the next two,
/// and the last.
std::size_t stage_stop(const Correction& correction, std::size_t stage) {
  const std::size_t last = correction.poses_after.size() - 1;
  if (stage == 3) return last;
  const auto at = std::ranges::find(correction.closed, true);
  if (at == correction.closed.end()) return last - 3 + stage;
  const auto first = static_cast<std::size_t>(at - correction.closed.begin());
  return std::min(first + stage, last);
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
  report.draw({.title = "Readings where odometry has the robot",
               .panels = {readings_panel(drive, "by odometry", false),
                          readings_panel(drive, "in truth", true)}});
  const std::size_t end = published_end(drive);
  const Eigen::Vector3d off = geometry::difference(drive.odometry[end], drive.truth[end]);
  report.printed("stops up to the last published position", static_cast<double>(end + 1), 62, "",
                 3.0);
  report.printed("odometry off there", off.head<2>().norm(), 8.5, "m", 1.5);
  report.printed("heading off there", std::fabs(off.z()) * 180.0 / std::numbers::pi, 17.0,
                 "degrees", 3.0);
  report.note(
      "Published: odometry (-3.93, 21.57, -2.83) at position 62, corrected to (-0.41, "
      "13.8, -3.1). The replica is made to err as much.");
}

void figure_8_14(Report& report) {
  const Drive& drive = report.runs().drive(kLoop);
  report.draw({.title = "Local maps where odometry has the robot",
               .panels = {maps_panel(drive, drive.odometry, drive.stops.size(), "by odometry"),
                          maps_panel(drive, drive.truth, drive.stops.size(), "in truth")}});
  report.states("by odometry the loop does not close (more than 5 m)",
                pose_errors(drive.odometry, drive.truth).last_m > 5.0);
}

std::string pose_as_text(const Pose2& T) {
  return fmt::format("({:.2f}, {:.2f}, {:.3f})", -T.y_m, T.x_m, T.theta_rad);
}

/// Figures 8.15, 8.17, 8.19, 8.21: the forward correction alone.
template <std::size_t Stage>
void forward_stage(Report& report) {
  const Drive& drive = report.runs().drive(kLoop);
  const std::size_t stop = stage_stop(report.runs().correction(kLoop), Stage);
  const auto& poses = report.runs().correction(kLoop, {.backward = false}).poses_after[stop];
  report.draw({.title = fmt::format("Position {} by the forward correction alone", stop + 1),
               .panels = {maps_panel(drive, poses, stop + 1, "corrected positions")}});
  const Eigen::Vector3d off = geometry::difference(poses[stop], drive.truth[stop]);
  const Eigen::Vector3d odometry_off =
      geometry::difference(drive.odometry[stop], drive.truth[stop]);
  report.show("position", static_cast<double>(stop + 1));
  report.show("error by odometry", odometry_off.head<2>().norm(), "m");
  report.at_most("error by the forward correction", off.head<2>().norm(), 5.6, "m");
  report.at_most("heading error by the forward correction",
                 std::fabs(off.z()) * 180.0 / std::numbers::pi, 14.2, "degrees");
  report.note(
      fmt::format("Here: odometry {}, forward {}, truth {}. Published at position 62: "
                  "forward (3.69, 17.68, -2.852), which the backward correction moves by "
                  "5.6 m and 14.2 degrees.",
                  pose_as_text(drive.odometry[stop]), pose_as_text(poses[stop]),
                  pose_as_text(drive.truth[stop])));
}

/// Figures 8.16, 8.18, 8.20, 8.22: after the backward correction.
template <std::size_t Stage>
void backward_stage(Report& report) {
  const Drive& drive = report.runs().drive(kLoop);
  const Correction& correction = report.runs().correction(kLoop);
  const std::size_t stop = stage_stop(correction, Stage);
  const auto& poses = correction.poses_after[stop];
  render::Figure figure;
  figure.title = fmt::format("Position {} after the backward correction", stop + 1);
  figure.panels.push_back(maps_panel(drive, poses, stop + 1, "positions that are used"));
  std::size_t solutions = 0;
  for (const Correction::Backward& backward : correction.backward) {
    if (backward.stop != stop) continue;
    solutions = backward.paths.size();
    FigurePanel panel;
    panel.title = "all solutions";
    for (std::size_t p = 0; p < backward.paths.size(); ++p) {
      std::vector<Pose2> path;
      for (const Pose2& T : backward.paths[p].T_first_pose) {
        path.push_back(backward.before[backward.first] * T);
      }
      add_path(panel, path, distinct_colour(p));
    }
    figure.panels.push_back(std::move(panel));
  }
  report.draw(figure);
  const Eigen::Vector3d off = geometry::difference(poses[stop], drive.truth[stop]);
  const auto& forward = report.runs().correction(kLoop, {.backward = false}).poses_after[stop];
  report.show("position", static_cast<double>(stop + 1));
  report.show("solutions at this position", static_cast<double>(solutions));
  report.at_most("error, of that of the forward correction", off.head<2>().norm(),
                 geometry::difference(forward[stop], drive.truth[stop]).head<2>().norm(), "m",
                 0.10);
  report.show("heading error", std::fabs(off.z()) * 180.0 / std::numbers::pi, "degrees");
  const std::vector<Pose2> so_far(poses.begin(),
                                  poses.begin() + static_cast<std::ptrdiff_t>(stop) + 1);
  report.show("mean error of all positions", pose_errors(so_far, drive.truth).mean_m, "m");
  report.states("the loop is closed",
                std::ranges::find(correction.closed, true) != correction.closed.end());
  if (Stage == 0) {
    double moved_m = 0.0;
    if (stop > 0) {
      for (std::size_t k = 0; k < stop; ++k) {
        moved_m = std::max(
            moved_m,
            (poses[k].position_m() - correction.poses_after[stop - 1][k].position_m()).norm());
      }
    }
    report.states("earlier positions are corrected, too", moved_m > 0.05);
    report.show("an earlier position moves by up to", moved_m, "m");
  }
  report.note(
      fmt::format("Here {}, truth {}. Published: (-1.12, 16.83, -3.047) or (-0.5, 16.9, "
                  "-3.11) at position 59, (-0.41, 13.8, -3.1) at position 62.",
                  pose_as_text(poses[stop]), pose_as_text(drive.truth[stop])));
}

void figure_8_23(Report& report) {
  const Drive& drive = report.runs().drive("apart");
  const topomap::GlobalMap map = fused(drive, drive.truth, drive.stops.size());
  FigurePanel apart = maps_panel(drive, drive.truth, drive.stops.size(), "(a) local maps");
  FigurePanel joined;
  joined.title = "(b) global map with virtual branches";
  add_map(joined, map, FigureColour::kGreen);
  report.draw({.title = "Local maps that do not overlap", .panels = {apart, joined}},
              "Virtual branches orange and dashed.");
  report.states("two successive local maps have nothing in common",
                std::ranges::any_of(map.branches, &topomap::MapBranch::is_virtual));
  report.show("virtual branches", static_cast<double>(std::ranges::count_if(
                                      map.branches, &topomap::MapBranch::is_virtual)));
}

void times_8_1(Report& report) {
  const Drive& drive = report.runs().drive(kLoop);
  const Correction& correction = report.runs().correction(kLoop);
  report.at_most("local map of a scan (cells of 5 cm, range 4 m there, 10 m here)",
                 drive.perception_ms, 400.0, "ms");
  const double matches = static_cast<double>(correction.slam->counts().tasks);
  report.at_most("match of two local maps (100 individuals, 50 generations)",
                 correction.wall_s / matches, 10.0, "s");
  report.show("matches of the drive", matches);
  if (correction.backward.empty()) throw std::runtime_error("no cycle was closed");
  const double start_s = support::monotonic_s();
  static_cast<void>(localization::correct_backward(correction.backward.front().problem,
                                                   correction.map().solutions(),
                                                   correction.config.thesis.backward));
  report.at_most("backward correction of a loop (hours there)", support::monotonic_s() - start_s,
                 7200.0, "s");
  report.at_most("all corrections of the drive (hours there)", correction.wall_s, 7200.0, "s");
}

/// Why matches that would have closed the loop were refused: "match not accepted: few inliers (3),
/// ...".
std::string refusals(const Correction& correction) {
  std::map<std::string, int> counts;
  for (const localization::LoopDecision& decision : correction.slam->loop_decisions()) {
    if (decision.outcome != localization::LoopOutcome::kAccepted) {
      ++counts[localization::explanation(decision)];
    }
  }
  std::string text;
  for (const auto& [why, count] : counts) {
    text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", why, count);
  }
  return text.empty() ? "none was tried" : text;
}

void forms_8_3(Report& report) {
  const Drive& drive = report.runs().drive(kLoop);
  Table table{"The loop by each form of the fitness.",
              {"form", "loop closed at", "last position off (m)", "mean error (m)", "time (s)",
               "matches refused"},
              {}};
  using localization::FitnessForm;
  using localization::MatchEvidence;
  struct Form {
    const char* name;
    FitnessForm form;
    MatchEvidence evidence = MatchEvidence::kScan;
    bool published = true;
  };
  for (const Form& form : {Form{"printed form", FitnessForm::kPrinted, MatchEvidence::kScan, false},
                           Form{"topological form", FitnessForm::kTopological},
                           Form{"combined form", FitnessForm::kCombined},
                           Form{"topological form without the gate", FitnessForm::kTopological,
                                MatchEvidence::kFitness, false}}) {
    const Correction& correction =
        report.runs().correction(kLoop, {.form = form.form, .evidence = form.evidence});
    const PoseErrors errors = pose_errors(correction.final_poses(), drive.truth);
    const auto at = std::ranges::find(correction.closed, true);
    const bool closed = at != correction.closed.end();
    table.rows.push_back(
        {form.name,
         closed ? std::to_string(at - correction.closed.begin() + 1) : std::string("never"),
         fmt::format("{:.2f}", errors.last_m), fmt::format("{:.2f}", errors.mean_m),
         fmt::format("{:.0f}", correction.wall_s), refusals(correction)});
    if (form.published) {
      report.states(fmt::format("{}: the loop closes", form.name), closed);
    }
    report.show(fmt::format("{}: last position off", form.name), errors.last_m, "m");
  }
  report.add(std::move(table));
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
  add(15, "where the loop first closes, forward correction alone", forward_stage<0>);
  add(16, "where the loop first closes, after the backward correction", backward_stage<0>);
  add(17, "one position on, forward correction alone", forward_stage<1>);
  add(18, "one position on, after the backward correction", backward_stage<1>);
  add(19, "two positions on, forward correction alone", forward_stage<2>);
  add(20, "two positions on, after the backward correction", backward_stage<2>);
  add(21, "the last position, forward correction alone", forward_stage<3>);
  add(22, "the last position, after the backward correction", backward_stage<3>);
  all.push_back({"figure-8.23", kThesis, "Figure 8.23",
                 "Successive local maps that do not overlap, joined by virtual branches",
                 figure_8_23, "", true});
  all.push_back(
      {"forms-8.3", kThesis, "Section 8.3", "Experiment 2 by each form of the fitness", forms_8_3,
       "The gate refuses all matches by nodes and branches alone that would close the loop, as the "
       "table says; but without the gate the steps go wrong, and no such match is tried",
       true});
  return all;
}

}  // namespace topogeo::reproduce
