// Thesis, 7.3.2: the fusion of local maps, step by step.
#include <algorithm>

#include "topogeo/support/format.hpp"

#include "reproduce/chapter7.hpp"
#include "reproduce/drawing.hpp"
#include "reproduce/shared_runs.hpp"

namespace topogeo::reproduce {
namespace {

using render::FigureColour;
using render::FigurePanel;
using topomap::NodeKind;

constexpr const char* kFused = "corridor";

std::size_t meaningful_nodes(const topomap::GlobalMap& map) {
  return static_cast<std::size_t>(std::ranges::count_if(map.nodes, [](const auto& node) {
    return node.kind != NodeKind::kFictitious && node.kind != NodeKind::kVirtual;
  }));
}

std::size_t meaningful_nodes(const topomap::LocalMap& map) {
  return static_cast<std::size_t>(std::ranges::count_if(map.nodes, [](const auto& node) {
    return node.in_main_graph && node.kind != NodeKind::kFictitious &&
           node.kind != NodeKind::kVirtual;
  }));
}

template <class Map>
double branch_length_m(const Map& map) {
  double sum_m = 0.0;
  for (const auto& branch : map.branches) {
    for (std::size_t i = 1; i < branch.points.size(); ++i) {
      sum_m += (branch.points[i].position_m - branch.points[i - 1].position_m).norm();
    }
  }
  return sum_m;
}

void figure_7_32(Report& report) {
  const Drive& drive = report.runs().drive(kFused);
  const Correction& correction = report.runs().correction(kFused, kForwardAlone);
  report.made_by(means_of(drive, correction));
  const topomap::GlobalMap first = fused(drive, correction.final_poses(), 1);
  FigurePanel local;
  local.title = "local map of position 1";
  add_points(local, *drive.stops[0], {}, FigureColour::kGrey);
  add_map(local, *drive.stops[0], {}, FigureColour::kRed);
  FigurePanel global;
  global.title = "global map of it alone";
  add_map(global, first, FigureColour::kGreen);
  report.draw({.title = "The first map", .panels = {local, global}});
  report.printed("nodes of the global map, as the local one",
                 static_cast<double>(meaningful_nodes(first)),
                 static_cast<double>(meaningful_nodes(*drive.stops[0])));
}

/// Figures 7.33 to 7.35: the map of position P is fused.
template <std::size_t P>
void fuse_position(Report& report) {
  const Drive& drive = report.runs().drive(kFused);
  const Correction& correction = report.runs().correction(kFused, kForwardAlone);
  const auto& poses = correction.final_poses();
  report.made_by(means_of(drive, correction));
  const topomap::LocalMap& local = *drive.stops[P - 1];
  const topomap::GlobalMap before = fused(drive, poses, P - 1);
  const topomap::GlobalMap after = fused(drive, poses, P);
  FigurePanel seen;
  seen.title = fmt::format("(a) local map of position {}", P);
  add_points(seen, local, {}, FigureColour::kGrey);
  add_map(seen, local, {}, FigureColour::kRed);
  FigurePanel both;
  both.title = fmt::format("(b) M{} and the local map", P - 1);
  add_map(both, before, FigureColour::kGreen);
  add_map(both, local, poses[P - 1], FigureColour::kRed);
  FigurePanel together;
  together.title = fmt::format("(c) M{}", P);
  add_map(together, after, FigureColour::kGreen);
  report.draw({.title = fmt::format("Position {} becomes part of the global map", P),
               .panels = {seen, both, together}},
              "Global map green, local map red.");
  const double all = static_cast<double>(meaningful_nodes(before) + meaningful_nodes(local));
  report.at_most("nodes of the fused map (of both: equivalent ones not fused)",
                 static_cast<double>(meaningful_nodes(after)), all);
  report.at_most("length of the branches of the fused map (of both)", branch_length_m(after),
                 branch_length_m(before) + branch_length_m(local), "m");
  report.states("equivalent branches are fused",
                branch_length_m(after) < 0.95 * (branch_length_m(before) + branch_length_m(local)));
  report.states("the map does not shrink", branch_length_m(after) > 0.95 * branch_length_m(before));
}

}  // namespace

std::vector<Experiment> chapter7_fusion() {
  const std::string kThesis = "Thesis";
  return {
      {"figure-7.32", kThesis, "Figure 7.32", "The first local map is the first global map",
       figure_7_32, "", true},
      {"figure-7.33", kThesis, "Figure 7.33", "The second local map is fused with the first",
       fuse_position<2>, "", true},
      {"figure-7.34", kThesis, "Figure 7.34", "The third local map is fused", fuse_position<3>, "",
       true},
      {"figure-7.35", kThesis, "Figure 7.35", "The fourth local map is fused", fuse_position<4>, "",
       true},
  };
}

}  // namespace topogeo::reproduce
