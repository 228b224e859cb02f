// Pictures of the stages of a map, for the algorithm that the configuration names: counterparts of
// Thesis, figs. 8.4-8.10 and 8.13-8.22 (docs/algorithms.md).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "topogeo/pipeline/config.hpp"
#include "topogeo/storage/map_document.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::results {

/// Poses of the stops of a drive after one stage of their correction.
struct CorrectionStage {
  std::string name;   ///< "1_odometry", "2_forward", "3_backward", "4_final"
  std::string title;  ///< heading of the picture
  topomap::Trajectory trajectory;
  std::vector<topomap::LoopClosure> loop_closures;
};

/// The four stages of a finished map: odometry alone; matches with recent local maps, without loop
/// closures; loops closed in their order; the document itself. The second and third stage are
/// computed again from the local maps, which takes as long as mapping did.
std::vector<CorrectionStage> correction_stages(const pipeline::Config& config,
                                               const storage::MapDocument& document);

/// Draws each stage as stage_NAME.png into an existing directory: the local maps at their poses of
/// that stage, and the resulting global map. Throws std::runtime_error naming the file.
void write_stage_pictures(const std::filesystem::path& directory, const pipeline::Config& config,
                          const storage::MapDocument& document, const std::string& title);

}  // namespace topogeo::results
