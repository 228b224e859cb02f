// Thesis, 7.3.1.2: the backward correction at the stop after the turn.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "topogeo/matching/odometry_model.hpp"
#include "topogeo/support/format.hpp"

#include "reproduce/chapter7.hpp"
#include "reproduce/chapter7_closing.hpp"
#include "reproduce/drawing.hpp"
#include "reproduce/shared_runs.hpp"

namespace topogeo::reproduce {
namespace {

using geometry::Pose2;
using localization::RelativeSolution;
using localization::StepKind;
using render::Figure;
using render::FigureColour;
using render::FigurePanel;

double size_as_number(std::size_t n) {
  return static_cast<double>(n);
}

/// The first stop with a view back along the corridor.
std::size_t turned_stop(const Drive& drive) {
  for (std::size_t k = 0; k < drive.truth.size(); ++k) {
    if (std::fabs(geometry::wrap_angle(drive.truth[k].theta_rad)) > 2.5) return k;
  }
  throw std::runtime_error("the drive does not turn");
}

/// Poses of all solutions of a stop against each earlier map.
std::vector<Pose2> solutions_of(const Correction& correction, std::size_t stop) {
  std::vector<Pose2> poses;
  const auto id = static_cast<std::uint32_t>(stop);
  for (const std::uint32_t earlier : correction.map().solutions().matched_with(id)) {
    for (const RelativeSolution& solution : correction.map().solutions().find(earlier, id)) {
      poses.push_back(correction.final_poses()[earlier] * solution.T_earlier_later);
    }
  }
  return poses;
}

void figure_7_22(Report& report) {
  const Drive& drive = report.runs().drive(kTurn);
  const Correction& correction = report.runs().correction(kTurn, kForwardAlone);
  report.made_by(means_of(drive, correction));
  FigurePanel panel = corridor_panel(drive, "best solutions of each position");
  std::size_t most = 0;
  for (std::size_t k = 1; k < drive.stops.size(); ++k) {
    render::FigureDots dots{{}, distinct_colour(k), 2.0};
    for (const Pose2& pose : solutions_of(correction, k)) {
      dots.points.push_back(on_page(pose.position_m()));
    }
    panel.dots.push_back(std::move(dots));
    const auto id = static_cast<std::uint32_t>(k);
    for (const std::uint32_t earlier : correction.map().solutions().matched_with(id)) {
      most = std::max(most, correction.map().solutions().find(earlier, id).size());
    }
  }
  report.draw({.title = "Solutions that are kept", .panels = {panel}},
              "A colour for each position.");
  report.at_least("solutions kept of a pair, up to", size_as_number(most), 3);
  report.show("stops up to the turn", size_as_number(turned_stop(drive) + 1));
}

void figure_7_23(Report& report) {
  const Drive& drive = report.runs().drive(kTurn);
  const Correction& correction = report.runs().correction(kTurn, kForwardAlone);
  report.made_by(means_of(drive, correction));
  FigurePanel panel = corridor_panel(drive, "best solution of each position");
  for (std::size_t k = 0; k < drive.stops.size(); ++k) {
    add_map(panel, *drive.stops[k], correction.final_poses()[k], FigureColour::kSky);
  }
  add_path(panel, drive.odometry, FigureColour::kBlack, true);
  add_path(panel, correction.final_poses(), FigureColour::kRed);
  report.draw({.title = "Forward correction up to the turn", .panels = {panel}},
              "Odometry black, corrected positions red, local maps blue.");
  const PoseErrors odometry = pose_errors(drive.odometry, drive.truth);
  const PoseErrors corrected = pose_errors(correction.final_poses(), drive.truth);
  report.show("largest error by odometry", odometry.largest_m, "m");
  report.show("largest error of corrected positions", corrected.largest_m, "m");
  report.states("forward correction is nearer to the truth than odometry",
                corrected.mean_m < odometry.mean_m);
}

/// The oldest map that the closing stop was matched with, and their solutions.
struct OldestMatch {
  std::size_t stop = 0;
  std::size_t reference = 0;
  std::vector<RelativeSolution> solutions;
};

OldestMatch oldest_match(const Correction& correction) {
  OldestMatch match;
  match.stop = first_closing(correction).stop;
  const auto id = static_cast<std::uint32_t>(match.stop);
  const auto with = correction.map().solutions().matched_with(id);
  if (with.empty()) throw std::runtime_error("the stop that closed a cycle has no solutions");
  match.reference = with.front();
  const auto found = correction.map().solutions().find(with.front(), id);
  match.solutions.assign(found.begin(), found.end());
  return match;
}

void figure_7_24(Report& report) {
  const Drive& drive = report.runs().drive(kTurn);
  const Correction& correction = report.runs().correction(kTurn, kSingleWalk);
  if (!closes(report, correction)) return;
  const OldestMatch match = oldest_match(correction);
  Figure figure;
  figure.title = "Several good solutions of one pair of maps";
  for (std::size_t i = 0; i < std::min<std::size_t>(match.solutions.size(), 3); ++i) {
    FigurePanel panel;
    panel.title = fmt::format("solution {}, fitness {:.3f}", i + 1, match.solutions[i].fitness);
    add_map(panel, *drive.stops[match.reference], {}, FigureColour::kRed);
    add_map(panel, *drive.stops[match.stop], match.solutions[i].T_earlier_later,
            FigureColour::kBlue);
    figure.panels.push_back(std::move(panel));
  }
  report.draw(figure, fmt::format("Map {} red, map {} blue.", match.reference + 1, match.stop + 1));
  report.states("there is more than one solution", match.solutions.size() > 1);
  report.show("solutions that are kept (40 at most)", size_as_number(match.solutions.size()));
}

void figure_7_25(Report& report) {
  const Correction& correction = report.runs().correction(kTurn, kSingleWalk);
  if (!closes(report, correction)) return;
  const OldestMatch match = oldest_match(correction);
  FigurePanel panel;
  panel.title = fmt::format("solutions of position {} seen from position {}", match.stop + 1,
                            match.reference + 1);
  render::FigureDots dots{{}, FigureColour::kBlue, 3.0};
  for (const RelativeSolution& solution : match.solutions) {
    dots.points.push_back(on_page(solution.T_earlier_later.position_m()));
  }
  panel.dots.push_back(std::move(dots));
  add_robot(panel, {}, FigureColour::kRed);
  report.draw({.title = "Best solutions relative to an earlier position", .panels = {panel}});
  report.states(
      "solutions are best first",
      std::ranges::is_sorted(match.solutions, std::ranges::greater{}, &RelativeSolution::fitness));
  report.printed("solutions beyond the 40 that are kept",
                 std::max(0.0, size_as_number(match.solutions.size()) - 40.0), 0.0);
}

void figure_7_26(Report& report) {
  const Drive& drive = report.runs().drive(kTurn);
  const Correction& correction = report.runs().correction(kTurn, kSingleWalk);
  if (!closes(report, correction)) return;
  const OldestMatch match = oldest_match(correction);
  FigurePanel panel = corridor_panel(drive, "in the frame of the first position");
  render::FigureDots earlier{{}, FigureColour::kRed, 3.0};
  render::FigureDots later{{}, FigureColour::kBlue, 3.0};
  double nearest_m = 1e9;
  for (const Pose2& T_map_reference : solutions_of(correction, match.reference)) {
    earlier.points.push_back(on_page(T_map_reference.position_m()));
    for (const RelativeSolution& solution : match.solutions) {
      const Pose2 pose = T_map_reference * solution.T_earlier_later;
      later.points.push_back(on_page(pose.position_m()));
      nearest_m =
          std::min(nearest_m, (pose.position_m() - drive.truth[match.stop].position_m()).norm());
    }
  }
  panel.dots = {later, earlier};
  report.draw({.title = "Solutions of both positions", .panels = {panel}},
              "Of the earlier position red, of the one after the turn blue.");
  report.at_most("best of them off the truth (resolution of the search)", nearest_m, 0.15, "m");
  report.show("combinations", size_as_number(later.points.size()));
}

/// Largest ratio of a pose's distance from its expected place to half the side of its search space;
/// up to 1 it lies inside.
double farthest_in_space(const Correction::Backward& backward, const Correction& correction) {
  double farthest = 0.0;
  const auto& config = correction.config.thesis.backward;
  for (std::size_t k = 1; k < backward.problem.poses.size(); ++k) {
    const auto& expected = backward.problem.poses[k].T_first_this;
    Eigen::Vector3d half = localization::search_half_width(expected.covariance, config.probability,
                                                           config.heading_sigmas);
    half = half.cwiseMax(
        Eigen::Vector3d(config.resolution_m, config.resolution_m, config.resolution_rad));
    const Eigen::Vector3d off =
        geometry::difference(backward.paths.front().T_first_pose[k], expected.T_a_b);
    farthest = std::max(farthest, off.cwiseAbs().cwiseQuotient(half).maxCoeff());
  }
  return farthest;
}

void figure_7_27(Report& report) {
  const Drive& drive = report.runs().drive(kTurn);
  const Correction& correction = report.runs().correction(kTurn, kSingleWalk);
  if (!closes(report, correction)) return;
  const Correction::Backward& backward = first_closing(correction);
  std::vector<Pose2> forward = backward.before;
  const auto& path = backward.paths.front().T_first_pose;
  std::vector<Pose2> solved;
  solved.reserve(path.size());
  for (const Pose2& T_first_pose : path) {
    solved.push_back(forward[backward.first] * T_first_pose);
  }
  Figure figure;
  figure.title = fmt::format("Backward correction from position {} to position {}",
                             backward.stop + 1, backward.first + 1);
  figure.columns = 5;
  const std::size_t panels = std::min<std::size_t>(15, solved.size());
  for (std::size_t p = 0; p < panels; ++p) {
    const std::size_t from = (solved.size() - 1) * (panels - 1 - p) / (panels - 1);
    FigurePanel panel = corridor_panel(
        drive,
        fmt::format("({}) back to {}", static_cast<char>('a' + p), backward.first + from + 1));
    panel.extent = {{-3.0, forward[backward.first].x_m - 2.0}, {3.0, 31.5}};
    add_path(panel, forward, FigureColour::kBlack, false, 1.5);
    add_path(panel, {solved.begin() + static_cast<std::ptrdiff_t>(from), solved.end()},
             FigureColour::kRed, false, 2.5);
    figure.panels.push_back(std::move(panel));
  }
  report.draw(figure, "Forward correction black, positions replaced so far red.");
  std::vector<Pose2> all(forward.begin(),
                         forward.begin() + static_cast<std::ptrdiff_t>(backward.first));
  all.insert(all.end(), solved.begin(), solved.end());
  report.states("the walk comes to the first position of the loop",
                path.size() == backward.problem.poses.size());
  report.worked_out("positions beyond their search space (1: its border)",
                    std::max(1.0, farthest_in_space(backward, correction)), 1.0);
  report.show("solutions found", size_as_number(backward.paths.size()));
  report.show("summed fitness of the best", backward.paths.front().summed_fitness);
  report.show("mean error of the forward correction", pose_errors(forward, drive.truth).mean_m,
              "m");
  report.show("mean error after the backward correction", pose_errors(all, drive.truth).mean_m,
              "m");
  report.states("the last position is off by less than the forward correction, or 0.15 m",
                pose_errors(all, drive.truth).last_m <=
                    std::max(0.15, pose_errors(forward, drive.truth).last_m));
}

/// The loop when steps of one kind only are allowed.
struct BackwardWay {
  const char* name;
  StepKind kind;
};

void backward_ways(Report& report) {
  const Drive& drive = report.runs().drive(kTurn);
  const Correction& correction = report.runs().correction(kTurn, kSingleWalk);
  if (!closes(report, correction)) return;
  const Correction::Backward& backward = first_closing(correction);
  Table table{"The same cycle closed by each way alone.",
              {"way", "steps of that way", "closed", "summed fitness", "mean error (m)"},
              {}};
  Figure figure;
  figure.title = "The loop closed by each way alone";
  figure.columns = 4;
  const BackwardWay ways[] = {{"matched with the map before (7.22)", StepKind::kMatched},
                              {"through an intermediate map (7.23, 7.24)", StepKind::kIntermediate},
                              {"odometry", StepKind::kOdometry},
                              {"grid of the search space", StepKind::kGrid}};
  std::vector<double> fitness;
  for (const BackwardWay& way : ways) {
    localization::BackwardProblem problem = backward.problem;
    localization::SolutionStore solutions = correction.map().solutions();
    for (std::uint32_t k = 1; k < problem.poses.size(); ++k) {
      const std::uint32_t id = problem.first_id + k;
      if (way.kind == StepKind::kIntermediate) solutions.put(id - 1, id, {});
      if (way.kind == StepKind::kOdometry || way.kind == StepKind::kGrid) {
        for (const std::uint32_t earlier : solutions.matched_with(id)) {
          solutions.put(earlier, id, {});
        }
      }
      if (way.kind == StepKind::kGrid) problem.poses[k].overlaps.clear();
    }
    std::size_t steps = 0;
    for (std::uint32_t k = 1; k < problem.poses.size(); ++k) {
      const auto options =
          localization::step_options(problem, solutions, correction.config.thesis.backward, k);
      steps += !options.empty() && options.front().kind == way.kind ? 1U : 0U;
    }
    const localization::BackwardResult found =
        localization::correct_backward(problem, solutions, correction.config.thesis.backward);
    const bool closed = found.outcome == localization::LoopSearchOutcome::kClosed;
    FigurePanel panel = corridor_panel(drive, way.name);
    add_path(panel, drive.truth, FigureColour::kGrey, true);
    double error_m = std::nan("");
    if (closed) {
      std::vector<Pose2> poses(
          backward.before.begin(),
          backward.before.begin() + static_cast<std::ptrdiff_t>(backward.first));
      for (const Pose2& T : found.paths.front().T_first_pose) {
        poses.push_back(backward.before[backward.first] * T);
      }
      add_path(panel, poses, FigureColour::kRed);
      error_m = pose_errors(poses, drive.truth).mean_m;
      fitness.push_back(found.paths.front().summed_fitness);
    }
    figure.panels.push_back(std::move(panel));
    table.rows.push_back({way.name, fmt::format("{} of {}", steps, problem.poses.size() - 1),
                          localization::to_string(found.outcome),
                          closed ? fmt::format("{:.2f}", fitness.back()) : "",
                          closed ? fmt::format("{:.2f}", error_m) : ""});
    if (way.kind != StepKind::kIntermediate) {
      report.states(fmt::format("{}: closes the cycle", way.name), closed);
    }
  }
  report.draw(figure, "Truth grey, positions red.");
  report.add(std::move(table));
  report.states("the largest fitness comes by matches with the map before",
                !fitness.empty() && fitness.front() >= std::ranges::max(fitness));
}

void figure_7_30(Report& report) {
  const Drive& drive = report.runs().drive(kTurn);
  const Correction& correction = report.runs().correction(kTurn, kSingleWalk);
  if (!closes(report, correction)) return;
  const Correction::Backward& backward = first_closing(correction);
  const auto& problem = backward.problem;
  const auto& last = problem.poses.back();
  // Each candidate alone: candidates without consistent poses are refused.
  const auto refused_alone = [&](const localization::BackwardCandidate& candidate) {
    localization::BackwardProblem only = problem;
    only.candidates = {candidate};
    return localization::correct_backward(only, correction.map().solutions(),
                                          correction.config.thesis.backward)
               .outcome != localization::LoopSearchOutcome::kClosed;
  };
  const auto refused =
      static_cast<std::size_t>(std::ranges::count_if(problem.candidates, refused_alone));
  // A candidate moved along the corridor until its map no longer sees the overlap.
  localization::BackwardCandidate moved = problem.candidates.at(0);
  moved.T_first_last.T_a_b.x_m += 20.0;
  const Pose2 T_first_last = moved.T_first_last.T_a_b;
  const std::uint32_t lost = moved.via;
  const Pose2 T_map_first = backward.before[backward.first];
  FigurePanel panel = corridor_panel(drive, "maps that no longer overlap");
  panel.extent = {{-8.0, -4.0}, {8.0, 54.0}};
  add_map(panel, *drive.stops[lost],
          T_map_first * problem.poses[lost - problem.first_id].T_first_this.T_a_b,
          FigureColour::kRed);
  add_map(panel, *drive.stops[backward.stop], T_map_first * T_first_last, FigureColour::kRed);
  report.draw({.title = "A candidate that is refused", .panels = {panel}},
              "The candidate is moved by 20 m; both maps red.");
  const auto& via = problem.poses[lost - problem.first_id];
  const auto view = topomap::seen_from(
      last.view, geometry::between(via.T_first_this.T_a_b, T_first_last), Eigen::Vector3d::Zero());
  report.states("the maps of the moved candidate do not overlap",
                !topomap::overlap(view, via.view));
  report.states("it is refused", refused_alone(moved));
  report.show("candidates", size_as_number(problem.candidates.size()));
  report.show("of them refused when alone", size_as_number(refused));
}

}  // namespace

std::vector<Experiment> chapter7_backward() {
  std::vector<Experiment> all;
  const auto add = [&](const char* row, const char* place, const char* what, void (*run)(Report&)) {
    all.push_back({row, "Thesis", place, what, run, "", true});
  };
  add("figure-7.22", "Figure 7.22", "The best solutions of each position up to the turn",
      figure_7_22);
  add("figure-7.23", "Figure 7.23", "The best one of each position alone", figure_7_23);
  add("figure-7.24", "Figure 7.24", "Several solutions of one pair of maps that are all good",
      figure_7_24);
  add("figure-7.25", "Figure 7.25",
      "Solutions of the position after the turn relative to an earlier one", figure_7_25);
  add("figure-7.26", "Figure 7.26",
      "The same in the frame of the first position, with those of the earlier position",
      figure_7_26);
  add("figure-7.27-7.29", "Figures 7.27 to 7.29",
      "The walk back from the position after the turn, position by position", figure_7_27);
  add("equations-7.22-7.24", "Equations 7.22 to 7.24",
      "The ways back to the position before: matched, through an intermediate map, odometry, grid",
      backward_ways);
  add("figure-7.30", "Figure 7.30",
      "A candidate at which maps that overlapped no longer do is refused", figure_7_30);
  return all;
}

}  // namespace topogeo::reproduce
