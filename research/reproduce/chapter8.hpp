// The parts of chapter 8, and helpers shared by their pictures.
#pragma once

#include <string>
#include <vector>

#include "reproduce/experiment.hpp"
#include "reproduce/shared_runs.hpp"

namespace topogeo::reproduce {

std::vector<Experiment> chapter8_corridor();
std::vector<Experiment> chapter8_loop();

/// Experiment 2 by each form of the fitness, in a table.
void forms_8_3(Report& report);

/// All readings of a drive, at the stops by odometry or by the truth, and its path.
render::FigurePanel readings_panel(const Drive& drive, const std::string& title, bool truth);
/// The local maps of the first stops at these poses, and their path.
render::FigurePanel maps_panel(const Drive& drive, const std::vector<geometry::Pose2>& poses,
                               std::size_t count, const std::string& title);

}  // namespace topogeo::reproduce
