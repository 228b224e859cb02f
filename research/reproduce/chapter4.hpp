// The parts of chapter 4, and helpers shared by their pictures.
#pragma once

#include <string>
#include <vector>

#include "topogeo/voronoi/voronoi_config.hpp"

#include "reproduce/experiment.hpp"
#include "reproduce/scenes.hpp"

namespace topogeo::reproduce {

std::vector<Experiment> chapter4_groups();
std::vector<Experiment> chapter4_grid();

/// A scene of the chapter with the map settings of the Thesis.
SeenScene scene4(const std::string& number, const voronoi::VoronoiConfig& config,
                 std::size_t place = 0);
/// The groups, coloured and numbered, and the robot.
render::FigurePanel groups_panel(const SeenScene& seen, const std::string& title);
/// The same with branches and nodes.
render::FigurePanel diagram_panel(const SeenScene& seen, const std::string& title);

}  // namespace topogeo::reproduce
