// Thesis, chapter 6: the uncertainty of odometry, the genetic search and its fitness.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "topogeo/matching/fitness_forms.hpp"
#include "topogeo/matching/odometry_model.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/random.hpp"
#include "topogeo/topomap/thesis_local_map.hpp"
#include "topogeo/voronoi/thesis_voronoi.hpp"

#include "genetic_search_parts.hpp"
#include "reproduce/drawing.hpp"
#include "reproduce/experiment.hpp"
#include "reproduce/scenes.hpp"

namespace topogeo::reproduce {
namespace {

using geometry::Pose2;
using localization::UncertainPose;
using render::Figure;
using render::FigureColour;
using render::FigurePanel;

constexpr double kDegree_rad = std::numbers::pi / 180.0;
constexpr double kSearchProbability = 0.95;  // as in the Thesis

void table_6_1(Report& report) {
  struct Row {
    double probability;
    double k2;
  };
  for (const Row& row : {Row{0.50, 1.386}, Row{0.90, 4.605}, Row{0.95, 5.991}}) {
    report.printed(fmt::format("k^2 of {:.0f} %", 100.0 * row.probability),
                   localization::ellipse_k2(row.probability), row.k2);
  }
}

/// Step between neighbouring values of a gene of `bits` bits over [-30, 50].
double gene_step(std::uint32_t bits) {
  localization::MatchTask task;
  task.T_reference_query = {10.0, 0.0, 0.0};
  task.half_width = {40.0, 40.0, 0.01};
  task.genetic.resolution_m = 80.0 / ((1U << bits) - 1U) * (1.0 + 1e-9);
  localization::GeneCoding coding;
  coding.bind(task);
  if (coding.bits() != bits) return std::nan("");
  return coding.decode({1, 0, 0}).T_reference_query.x_m -
         coding.decode({0, 0, 0}).T_reference_query.x_m;
}

void table_6_2(Report& report) {
  struct Row {
    std::uint32_t bits;
    double step;
  };
  for (const Row& row : {Row{2, 26.67}, Row{4, 5.33}, Row{6, 1.27}, Row{8, 0.31}}) {
    report.printed(fmt::format("step of a gene of {} bits", row.bits), gene_step(row.bits),
                   row.step);
  }
}

void table_6_4(Report& report) {
  constexpr std::array<double, 4> kFitness{150.0, 15.0, 360.0, 90.0};
  constexpr std::array<double, 4> kPercent{24.4, 2.5, 58.5, 14.6};
  constexpr int kSpins = 400000;
  std::vector<localization::Individual> population;
  population.reserve(kFitness.size());
  for (const double fitness : kFitness) population.push_back({{}, fitness});
  localization::Roulette roulette;
  roulette.fill(population);
  support::Random random(1);
  std::array<int, 4> drawn{};
  for (int i = 0; i < kSpins; ++i) ++drawn[roulette.spin(random)];
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    report.printed(fmt::format("share of individual {}", i + 1), 100.0 * drawn[i] / kSpins,
                   kPercent[i], "%");
  }
  report.note("Shares of 400,000 spins of the wheel.");
}

/// A drive in steps of 0.5 m: ahead, a bend to the left, ahead.
std::vector<UncertainPose> uncertain_drive() {
  constexpr int kSteps = 24;
  std::vector<UncertainPose> poses{{}};
  for (int i = 0; i < kSteps; ++i) {
    const double turn_rad = i >= 10 && i < 14 ? 22.5 * kDegree_rad : 0.0;
    poses.push_back(localization::advance(poses.back(), {0.5, 0.0, turn_rad}, {}));
  }
  return poses;
}

render::FigureLine ellipse_line(const UncertainPose& pose, FigureColour colour) {
  const localization::ErrorEllipse ellipse = localization::error_ellipse(
      pose.covariance.topLeftCorner<2, 2>(), localization::ellipse_k2(kSearchProbability));
  render::FigureLine line{{}, colour, 1.25};
  const double cos = std::cos(ellipse.direction_rad);
  const double sin = std::sin(ellipse.direction_rad);
  for (int i = 0; i < 60; ++i) {
    const double angle_rad = 2.0 * std::numbers::pi * i / 60;
    const double along_m = ellipse.semi_major_m * std::cos(angle_rad);
    const double across_m = ellipse.semi_minor_m * std::sin(angle_rad);
    line.points.push_back(
        on_page(pose.T_a_b.position_m() +
                Eigen::Vector2d(cos * along_m - sin * across_m, sin * along_m + cos * across_m)));
  }
  line.closed = true;
  return line;
}

topomap::VisibleRectangle rectangle_of(const UncertainPose& pose) {
  const Eigen::Vector2d half_m =
      localization::search_half_width(pose.covariance, kSearchProbability, 1.0).head<2>();
  return {pose.T_a_b.position_m() - half_m, pose.T_a_b.position_m() + half_m};
}

FigurePanel drive_panel(const std::vector<UncertainPose>& poses, const std::string& title) {
  FigurePanel panel;
  panel.title = title;
  std::vector<Pose2> path;
  path.reserve(poses.size());
  for (const UncertainPose& pose : poses) path.push_back(pose.T_a_b);
  add_path(panel, path, FigureColour::kBlack);
  return panel;
}

void figure_6_2(Report& report) {
  const std::vector<UncertainPose> poses = uncertain_drive();
  FigurePanel panel = drive_panel(poses, "95 % ellipses of every fourth pose");
  bool grows = true;
  double before_m2 = 0.0;
  for (std::size_t i = 4; i < poses.size(); i += 4) {
    panel.lines.push_back(ellipse_line(poses[i], FigureColour::kBlue));
    const double area_m2 = poses[i].covariance.topLeftCorner<2, 2>().trace();
    grows &= area_m2 > before_m2;
    before_m2 = area_m2;
  }
  report.draw({.title = "The error of odometry grows along the drive", .panels = {panel}});
  report.states("each ellipse is larger than the one before", grows);
}

void figure_6_4(Report& report) {
  const std::vector<UncertainPose> poses = uncertain_drive();
  FigurePanel ellipses = drive_panel(poses, "(a) ellipses");
  FigurePanel rectangles = drive_panel(poses, "(b) rectangles around them");
  double off_m = 0.0;
  for (std::size_t i = 4; i < poses.size(); i += 4) {
    const render::FigureLine line = ellipse_line(poses[i], FigureColour::kBlue);
    ellipses.lines.push_back(line);
    rectangles.lines.push_back(line);
    rectangles.lines.back().colour = FigureColour::kSky;
    const topomap::VisibleRectangle rectangle = rectangle_of(poses[i]);
    add_rectangle(rectangles, rectangle, FigureColour::kRed);
    double ahead_m = -1e9;
    for (const Eigen::Vector2d& point : line.points) ahead_m = std::max(ahead_m, point.y());
    const double size_m = rectangle.high_m.x() - poses[i].T_a_b.x_m;
    off_m = std::max(off_m, std::fabs(rectangle.high_m.x() - ahead_m) / size_m);
  }
  report.draw({.title = "Search spaces along the drive", .panels = {ellipses, rectangles}});
  report.worked_out("rectangle beyond its ellipse, of its half side", off_m, 0.0);
}

/// Two maps of one place, with the query displaced from its true pose in decreasing steps.
struct DisplacedPair {
  topomap::LocalMap reference;
  topomap::LocalMap query;
  Pose2 T_true;
  std::vector<Pose2> displacements;  ///< of the query, in its own frame; the last is the identity
};

struct DisplacedFitness {
  std::vector<double> printed;
  std::vector<double> topological;
};

DisplacedFitness fitness_of(const DisplacedPair& pair) {
  const localization::Reference reference =
      localization::make_reference(localization::extract_features(pair.reference));
  const localization::MatchFeatures query = localization::extract_features(pair.query);
  localization::MatchTask task;
  task.T_reference_query = pair.T_true;
  task.covariance = Eigen::Matrix3d::Identity();
  task.half_width = {3.0, 3.0, 3.0};
  DisplacedFitness result;
  for (const bool printed : {true, false}) {
    task.fitness_form =
        printed ? localization::FitnessForm::kPrinted : localization::FitnessForm::kTopological;
    const localization::FitnessForms forms(reference, query, task);
    for (const Pose2& off : pair.displacements) {
      (printed ? result.printed : result.topological).push_back(forms.chosen()(pair.T_true * off));
    }
  }
  return result;
}

/// A fitness in metres by 6.30, in a unit of which a metre has `per_metre`.
double in_unit(double fitness, double per_metre) {
  return fitness > 0.0 ? 1.0 / (per_metre * (1.0 / fitness - 1.0) + 1.0) : 0.0;
}

void compare_displaced(Report& report, const DisplacedPair& pair,
                       const std::vector<double>& published) {
  const DisplacedFitness fitness = fitness_of(pair);
  Figure figure;
  figure.title = "Fitness of displaced poses: printed and topological form";
  Table table{
      "The poses of the published panels are not printed, so their values are not compared "
      "one by one.",
      {"pose", "right (m)", "forward (m)", "turn (degrees)", "printed form (m)",
       "printed form (cm)", "printed form (mm)", "topological form", "published panel"},
      {}};
  for (std::size_t i = 0; i < pair.displacements.size(); ++i) {
    FigurePanel panel;
    const Pose2& off = pair.displacements[i];
    panel.title = fmt::format("({}) printed {:.4f}, topological {:.4f}", static_cast<char>('a' + i),
                              fitness.printed[i], fitness.topological[i]);
    add_map(panel, pair.reference, {}, FigureColour::kRed);
    add_map(panel, pair.query, pair.T_true * off, FigureColour::kBlue);
    add_robot(panel, {}, FigureColour::kRed);
    add_robot(panel, pair.T_true * off, FigureColour::kBlue);
    panel.extent = {{-3.5, -1.5}, {3.5, 4.5}};
    // If the query lies outside of that, show its whole surroundings.
    constexpr double kReach_m = 4.5;
    const Eigen::Vector2d at_m = on_page((pair.T_true * off).position_m());
    if ((at_m.array() < panel.extent->low.array()).any()) {
      panel.extent->low = panel.extent->low.cwiseMin((at_m.array() - kReach_m).matrix());
      panel.extent->high = panel.extent->high.cwiseMax((at_m.array() + kReach_m).matrix());
    }
    figure.panels.push_back(std::move(panel));
    table.rows.push_back(
        {std::string(1, static_cast<char>('a' + i)), fmt::format("{:.2f}", -off.y_m),
         fmt::format("{:.2f}", off.x_m), fmt::format("{:.0f}", off.theta_rad / kDegree_rad),
         fmt::format("{:.4f}", fitness.printed[i]),
         fmt::format("{:.4f}", in_unit(fitness.printed[i], 100.0)),
         fmt::format("{:.4f}", in_unit(fitness.printed[i], 1000.0)),
         fmt::format("{:.4f}", fitness.topological[i]), fmt::format("{:g}", published[i])});
  }
  report.draw(figure, "Reference red, query blue.");
  report.add(std::move(table));
  report.printed("printed form: fitness far off", fitness.printed.front(), published.front());
  report.states("printed form: grows from pose to pose", std::ranges::is_sorted(fitness.printed));
  report.states("printed form: largest where the maps lie on each other",
                fitness.printed.back() >= std::ranges::max(fitness.printed));
  report.printed("printed form: fitness where they lie on each other", fitness.printed.back(),
                 published.back());
  for (std::size_t i = 1; i < published.size(); ++i) {
    report.show(
        fmt::format("mean distance behind the published panel ({})", static_cast<char>('a' + i)),
        1.0 / published[i] - 1.0, "units of length");
  }
  const std::string by = "topological form";
  report.beside("grows from pose to pose", std::ranges::is_sorted(fitness.topological) ? 1.0 : 0.0,
                "yes", by);
  report.beside("fitness where they lie on each other", fitness.topological.back(), "", by);
  report.note(
      "By 6.31 a fitness f stands for a mean distance of 1/f - 1, which the rows above give for "
      "the published panels. The unit is not printed. In metres or centimetres, panel (b) of "
      "figure 6.17 would be 50 m or more, but two elements of maps of 4 m of range are at most "
      "8 m apart and the factor 6.36 is at most 1; in millimetres it is 5 m, and the last "
      "panels are 8 mm and 1 mm, the rest that a search leaves. So the published values fit "
      "the printed equations in millimetres, at poses that a search found; they need no factor "
      "that differs from 6.36. At an exact alignment the printed fitness is 1 in any unit.");
}

DisplacedPair displaced(const SeenScene& reference, const SeenScene& query,
                        std::vector<Pose2> displacements) {
  return {reference.map, query.map, geometry::between(reference.T_world_laser, query.T_world_laser),
          std::move(displacements)};
}

void figure_6_16(Report& report) {
  const auto config = voronoi::thesis_voronoi();
  const SeenScene reference = see_scene("4_16", config, topomap::thesis_local_map());
  const SeenScene query =
      see(reference.world, {0.4, 0.05, 2.0 * kDegree_rad}, config, topomap::thesis_local_map());
  compare_displaced(report,
                    displaced(reference, query,
                              {{0.0, 3.0, 1.2},
                               {0.0, 0.55, 25.0 * kDegree_rad},
                               {0.0, 0.4, 16.0 * kDegree_rad},
                               {0.0, 0.25, 10.0 * kDegree_rad},
                               {0.0, 0.1, 5.0 * kDegree_rad},
                               {0.0, 0.0, 0.0}}),
                    {0.0, 0.0011, 0.002, 0.0052, 0.0468, 0.1087});
}

void figure_6_17(Report& report) {
  const auto config = voronoi::thesis_splitting_alone();
  const SeenScene reference = see_scene("4_08", config, topomap::thesis_local_map());
  const SeenScene query =
      see(reference.world, {0.4, 0.05, 2.0 * kDegree_rad}, config, topomap::thesis_local_map());
  report.worked_out("nodes of both maps",
                    static_cast<double>(count_nodes(reference.map, topomap::NodeKind::kReal) +
                                        count_nodes(query.map, topomap::NodeKind::kReal)),
                    2.0);
  compare_displaced(report,
                    displaced(reference, query,
                              {{3.0, 4.5, 0.7},
                               {0.5, 0.45, 24.0 * kDegree_rad},
                               {0.35, 0.3, 16.0 * kDegree_rad},
                               {0.2, 0.2, 10.0 * kDegree_rad},
                               {0.1, 0.1, 5.0 * kDegree_rad},
                               {0.0, 0.0, 0.0}}),
                    {0.0, 0.0002, 0.05, 0.21, 0.33, 0.50});
}

}  // namespace

std::vector<Experiment> chapter6() {
  const std::string kThesis = "Thesis";
  const std::string kPrintedForm =
      "The published poses are not printed, and their best one is that of a search, not an exact "
      "alignment; where the printed form falls towards it, fewer elements were equivalent before "
      "(docs/algorithms.md, Fitness, errata)";
  return {
      {"figure-6.2", kThesis, "Figure 6.2", "Error ellipses of the positions of a drive",
       figure_6_2},
      {"table-6.1", kThesis, "Table 6.1", "k^2 of an error ellipse by its probability", table_6_1},
      {"figure-6.4", kThesis, "Figure 6.4",
       "Search spaces along a drive: ellipses, and the rectangles around them", figure_6_4},
      {"table-6.2", kThesis, "Table 6.2",
       "Step between the values of a gene over [-30, 50] by its number of bits", table_6_2},
      {"table-6.4", kThesis, "Table 6.4", "Shares of four individuals on the roulette wheel",
       table_6_4},
      {"figure-6.16", kThesis, "Figure 6.16",
       "Fitness of two local maps with one equivalent branch at six poses", figure_6_16,
       kPrintedForm},
      {"figure-6.17", kThesis, "Figure 6.17",
       "Fitness of two local maps with a node and four branches in common at six poses",
       figure_6_17, kPrintedForm},
  };
}

}  // namespace topogeo::reproduce
