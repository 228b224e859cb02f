// Thesis, 7.3.1.1: uncertainty relative to earlier positions, fields of view, forward correction.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "topogeo/matching/odometry_model.hpp"
#include "topogeo/support/format.hpp"

#include "reproduce/chapter7.hpp"
#include "reproduce/drawing.hpp"
#include "reproduce/shared_runs.hpp"

namespace topogeo::reproduce {
namespace {

using geometry::Pose2;
using localization::UncertainPose;
using render::Figure;
using render::FigureColour;
using render::FigurePanel;
using topomap::VisibleRectangle;

constexpr const char* kPositions = "positions";

double as_number(std::size_t n) {
  return static_cast<double>(n);
}

Eigen::Vector3d half_width_of(const UncertainPose& pose, const Correction& correction) {
  return localization::search_half_width(pose.covariance, correction.config.search_probability,
                                         correction.config.search_heading_sigmas);
}

/// Odometry from stop `from` to stop `to`.
UncertainPose by_odometry(const Correction& correction, std::size_t from, std::size_t to) {
  UncertainPose sum;
  for (std::size_t k = from + 1; k <= to; ++k) {
    sum = localization::compose(sum, correction.map().stop(k).T_previous_this);
  }
  return sum;
}

void figure_7_6(Report& report) {
  const Correction& correction = report.runs().correction(kPositions, kForwardAlone);
  report.made_by(means_of(report.runs().drive(kPositions), correction));
  FigurePanel panel;
  panel.title = "search spaces of position 5";
  Table table{"Half sides of the search space of position 5 relative to each earlier one.",
              {"relative to", "across (m)", "along (m)", "heading (degrees)"},
              {}};
  bool grows = true;
  double before_m2 = 0.0;
  const Pose2 T_map_five = correction.final_poses()[4];
  for (std::size_t i = 4; i-- > 0;) {
    const UncertainPose pose = by_odometry(correction, i, 4);
    const Eigen::Vector3d half = half_width_of(pose, correction);
    add_rectangle(
        panel, {T_map_five.position_m() - half.head<2>(), T_map_five.position_m() + half.head<2>()},
        distinct_colour(i));
    panel.texts.push_back(
        {on_page(T_map_five.position_m() + Eigen::Vector2d(half.x() - 0.1, half.y() - 0.15)),
         std::to_string(i + 1), distinct_colour(i)});
    table.rows.push_back({std::to_string(i + 1), fmt::format("{:.2f}", half.y()),
                          fmt::format("{:.2f}", half.x()),
                          fmt::format("{:.1f}", half.z() * 180.0 / std::numbers::pi)});
    grows &= half.x() * half.y() > before_m2;
    before_m2 = half.x() * half.y();
  }
  std::vector<Pose2> path(correction.final_poses().begin(), correction.final_poses().begin() + 5);
  add_path(panel, path, FigureColour::kBlack, false, 4.0);
  report.draw({.title = "Uncertainty of a position relative to earlier ones", .panels = {panel}},
              "Numbered by the position that the rectangle is relative to.");
  report.add(std::move(table));
  report.states("the space is larger the further back the reference lies", grows);
}

double area_m2(const VisibleRectangle& r) {
  const Eigen::Vector2d size_m = r.high_m - r.low_m;
  return size_m.x() * size_m.y();
}

void figure_7_9(Report& report) {
  const Correction& correction = report.runs().correction(kPositions, kForwardAlone);
  report.made_by(means_of(report.runs().drive(kPositions), correction));
  const UncertainPose predicted = by_odometry(correction, 0, 1);
  const Eigen::Vector3d half = half_width_of(predicted, correction);
  const VisibleRectangle view = correction.map().stop(1).view;
  const VisibleRectangle total = topomap::seen_from(view, predicted.T_a_b, half);
  constexpr std::array<std::array<double, 2>, 4> kCorners{
      {{-1.0, 1.0}, {1.0, 1.0}, {1.0, -1.0}, {-1.0, -1.0}}};
  const std::array<const char*, 4> names{"lower left", "upper left", "upper right", "lower right"};
  Figure figure;
  figure.title = "Field of view of position 2, seen from position 1";
  VisibleRectangle sum = view;
  for (std::size_t c = 0; c < kCorners.size(); ++c) {
    Pose2 corner = predicted.T_a_b;
    corner.x_m += kCorners[c][0] * half.x();
    corner.y_m += kCorners[c][1] * half.y();
    const VisibleRectangle seen = topomap::seen_from(view, corner, {0.0, 0.0, half.z()});
    sum = c == 0
              ? seen
              : VisibleRectangle{sum.low_m.cwiseMin(seen.low_m), sum.high_m.cwiseMax(seen.high_m)};
    FigurePanel panel;
    panel.title = std::string(names[c]) + " corner";
    add_map(panel, *report.runs().drive(kPositions).stops[1], corner, FigureColour::kBlue);
    add_rectangle(panel, seen, FigureColour::kGreen);
    add_rectangle(panel,
                  {predicted.T_a_b.position_m() - half.head<2>(),
                   predicted.T_a_b.position_m() + half.head<2>()},
                  FigureColour::kBlack, true);
    panel.extent = {on_page({total.low_m.x(), total.high_m.y()}),
                    on_page({total.high_m.x(), total.low_m.y()})};
    figure.panels.push_back(std::move(panel));
  }
  FigurePanel panel;
  panel.title = "all together";
  add_rectangle(panel, total, FigureColour::kGreen);
  add_rectangle(panel, sum, FigureColour::kBlue, true);
  figure.panels.push_back(std::move(panel));
  report.draw(figure, "Search space dashed black; the total green, that of the corners dashed.");
  report.worked_out("union of the corners by the total, area", area_m2(sum) / area_m2(total), 1.0);
}

/// Two local maps with their fields of view, the later one seen from the earlier.
FigurePanel views_panel(const Drive& drive, const Correction& correction, std::size_t earlier,
                        std::size_t later, bool& overlaps) {
  const UncertainPose predicted = by_odometry(correction, earlier, later);
  const Eigen::Vector3d half = half_width_of(predicted, correction);
  const VisibleRectangle seen =
      topomap::seen_from(correction.map().stop(later).view, predicted.T_a_b, half);
  overlaps = topomap::overlap(seen, correction.map().stop(earlier).view);
  FigurePanel panel;
  panel.title = fmt::format("positions {} and {}", earlier + 1, later + 1);
  add_map(panel, *drive.stops[earlier], {}, FigureColour::kRed);
  add_map(panel, *drive.stops[later], predicted.T_a_b, FigureColour::kTeal);
  add_rectangle(panel, correction.map().stop(earlier).view, FigureColour::kBlue);
  add_rectangle(panel, seen, FigureColour::kGreen);
  add_rectangle(panel,
                {predicted.T_a_b.position_m() - half.head<2>(),
                 predicted.T_a_b.position_m() + half.head<2>()},
                FigureColour::kBlack, true);
  add_robot(panel, {}, FigureColour::kBlack);
  add_robot(panel, predicted.T_a_b, FigureColour::kBlue);
  return panel;
}

void figure_7_10(Report& report) {
  // Each position has its own match, so the search spaces are those of single steps.
  const Correction& correction = report.runs().correction(kPositions, kForwardAlone);
  const Drive& drive = report.runs().drive(kPositions);
  const auto& stop = correction.map();
  report.made_by(means_of(drive, correction));
  const Pose2 T_first_last =
      geometry::between(correction.final_poses()[0], correction.final_poses()[10]);
  const VisibleRectangle far =
      topomap::seen_from(stop.stop(10).view, T_first_last, Eigen::Vector3d::Zero());
  bool near = false;
  Figure figure;
  figure.title = "Fields of view that do not overlap, and that do";
  FigurePanel apart;
  apart.title = "positions 1 and 11";
  add_map(apart, *drive.stops[0], {}, FigureColour::kRed);
  add_map(apart, *drive.stops[10], T_first_last, FigureColour::kTeal);
  add_rectangle(apart, stop.stop(0).view, FigureColour::kBlue);
  add_rectangle(apart, far, FigureColour::kGreen);
  figure.panels = {apart, views_panel(drive, correction, 0, 1, near)};
  report.draw(figure, "Field of view of the earlier map blue, of the later one green.");
  report.states("(a) fields of view of positions 1 and 11 are apart",
                !topomap::overlap(far, stop.stop(0).view));
  report.states("(b) those of positions 1 and 2 overlap", near);
}

void figure_7_11(Report& report) {
  const Drive& drive = report.runs().drive(kPositions);
  FigurePanel panel;
  panel.title = "local map of position 1";
  add_points(panel, *drive.stops[0], {}, FigureColour::kGrey);
  add_map(panel, *drive.stops[0], {}, FigureColour::kBlue);
  add_robot(panel, {}, FigureColour::kBlack);
  report.draw({.title = "The map where the robot starts", .panels = {panel}});
  report.made_by(means_of(drive));
  report.states("the first map has branches", !drive.stops[0]->branches.empty());
  // The scene knows the distance of each point of a branch to the nearest wall.
  constexpr double kTwoCells_m = 0.10;
  double points = 0.0;
  double right = 0.0;
  for (const topomap::LocalBranch& branch : drive.stops[0]->branches) {
    if (branch.is_virtual || !branch.in_main_graph) continue;
    for (const topomap::BranchPoint& point : branch.points) {
      const double wall_m = world::clearance_m(drive.world, drive.T_world_first * point.position_m);
      points += 1.0;
      right += std::fabs(wall_m - point.clearance_m) <= kTwoCells_m ? 1.0 : 0.0;
    }
  }
  report.worked_out("points of branches whose clearance is the distance to the walls",
                    100.0 * right / points, 100.0, "%");
}

Table positions_table(const Drive& drive, const Correction& correction, std::size_t last) {
  Table table{"Positions in the frame of the first: right, forward (m), heading (rad).",
              {"position", "odometry", "corrected", "truth", "overlaps with"},
              {}};
  const auto text = [](const Pose2& T) {
    return fmt::format("({:.3f}, {:.3f}, {:.4f})", -T.y_m, T.x_m, T.theta_rad);
  };
  for (std::size_t k = 0; k <= last; ++k) {
    std::string overlaps;
    for (const std::uint32_t id : correction.overlaps[k]) {
      overlaps += fmt::format("{}{}", overlaps.empty() ? "" : ", ", id + 1);
    }
    table.rows.push_back({std::to_string(k + 1), text(drive.odometry[k]),
                          text(correction.final_poses()[k]), text(drive.truth[k]), overlaps});
  }
  return table;
}

/// Figures 7.12 to 7.21: forward correction of position P.
template <std::size_t P>
void forward_position(Report& report) {
  const std::size_t k = P - 1;
  const Drive& drive = report.runs().drive(kPositions);
  const Correction& correction = report.runs().correction(kPositions, kForwardAlone);
  report.made_by(means_of(drive, correction));
  Figure figure;
  figure.title = fmt::format("Forward correction of position {}", P);
  for (const std::uint32_t earlier : correction.overlaps[k]) {
    if (figure.panels.size() == 2) break;
    bool overlaps = false;
    figure.panels.push_back(views_panel(drive, correction, earlier, k, overlaps));
  }
  FigurePanel panel;
  panel.title = "maps at their corrected positions";
  for (std::size_t i = 0; i <= k; ++i) {
    add_map(panel, *drive.stops[i], correction.final_poses()[i], distinct_colour(i));
  }
  const auto until = [k](const std::vector<Pose2>& poses) {
    return std::vector<Pose2>(poses.begin(), poses.begin() + static_cast<std::ptrdiff_t>(k) + 1);
  };
  add_path(panel, until(drive.odometry), FigureColour::kBlack, true, 4.0);
  add_path(panel, until(correction.final_poses()), FigureColour::kRed, false, 4.0);
  figure.panels.push_back(std::move(panel));
  report.draw(figure, "Right: odometry black, corrected positions red.");
  const PoseErrors odometry = pose_errors(until(drive.odometry), drive.truth);
  const PoseErrors corrected = pose_errors(until(correction.final_poses()), drive.truth);
  const auto& overlaps = correction.overlaps[k];
  report.states("the map overlaps with the one before",
                std::ranges::find(overlaps, static_cast<std::uint32_t>(k - 1)) != overlaps.end());
  report.states("no cycle closes", !correction.closed[k]);
  report.show("error by odometry", odometry.last_m, "m");
  report.show("error of the corrected position", corrected.last_m, "m");
  report.show("heading error of the corrected position", corrected.last_rad, "rad");
  report.states("correction brings the position nearer to the truth, or within 0.15 m of it",
                corrected.last_m <= std::max(odometry.last_m, 0.15));
  const Correction& product = report.runs().correction(kPositions, kProductForward);
  report.beside("error of the corrected position",
                (product.final_poses()[k].position_m() - drive.truth[k].position_m()).norm(), "m",
                matcher_text(product.config));
  if (P == 2) report.printed("maps in MS_2", as_number(overlaps.size()), 1);
  if (P == 3) report.printed("maps in MS_3", as_number(overlaps.size()), 1);
  if (P == 11) {
    report.add(positions_table(drive, correction, k));
    const Correction& farther = report.runs().correction("positions, 10 m", kProductForward);
    report.beside(
        "error of the corrected position",
        pose_errors(farther.final_poses(), report.runs().drive("positions, 10 m").truth).last_m,
        "m", matcher_text(farther.config) + ", 10 m");
    const Eigen::Vector3d corrected_by =
        geometry::difference(correction.final_poses()[k], drive.odometry[k]);
    report.printed("odometry corrected by", corrected_by.head<2>().norm(), 1.17, "m");
    report.printed("heading corrected by", std::fabs(corrected_by.z()), 0.0335, "rad");
    report.note(
        "Published: (0.15, 24.21, 0.0245) by odometry becomes (-1.02, 24.15, 0.058), a "
        "correction of 1.17 m; the truth is not known there. The replica's odometry ends 1 m and "
        "1.5 degrees off, so that a right correction is as large as the published one.");
  }
}

}  // namespace

std::vector<Experiment> chapter7_forward() {
  const std::string kThesis = "Thesis";
  const std::string kWhy =
      "In a stretch of corridor without doors nodes and branches do not say where along it the "
      "robot is";
  std::vector<Experiment> all{
      {"figure-7.6", kThesis, "Figure 7.6",
       "Search space of a position relative to each earlier one", figure_7_6, "", true},
      {"figure-7.9", kThesis, "Figure 7.9",
       "Field of view at the four corners of a search space, and their union", figure_7_9,
       "The total here holds how far a corner swings out between the two extreme headings", true},
      {"figure-7.10", kThesis, "Figure 7.10",
       "Fields of view of two maps that do not overlap, and of two that do", figure_7_10, "", true},
      {"figure-7.11", kThesis, "Figure 7.11", "The local map of the first position", figure_7_11,
       "", true}};
  const auto add = [&](int figure, int position, void (*run)(Report&)) {
    all.push_back({fmt::format("figure-7.{}", figure), kThesis, fmt::format("Figure 7.{}", figure),
                   fmt::format("Forward correction of position {}: overlapping fields of view, "
                               "position by odometry and corrected",
                               position),
                   run, kWhy, true});
  };
  add(12, 2, forward_position<2>);
  add(13, 3, forward_position<3>);
  add(14, 4, forward_position<4>);
  add(15, 5, forward_position<5>);
  add(16, 6, forward_position<6>);
  add(17, 7, forward_position<7>);
  add(18, 8, forward_position<8>);
  add(19, 9, forward_position<9>);
  add(20, 10, forward_position<10>);
  add(21, 11, forward_position<11>);
  return all;
}

}  // namespace topogeo::reproduce
