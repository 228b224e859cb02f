// Pictures of the stages of a map: the counterparts of Thesis, figs. 8.4-8.10 and 8.13-8.22
// (docs/algorithms.md), for the algorithm that the configuration names.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "topogeo/pipeline/config.hpp"
#include "topogeo/storage/map_document.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::results {

/// Where the stops of a drive lie after one stage of their correction.
struct CorrectionStage {
  std::string name;   ///< "1_odometry", "2_forward", "3_backward", "4_final"
  std::string title;  ///< for people
  topomap::Trajectory trajectory;
  std::vector<topomap::LoopClosure> loop_closures;
};

/// The four stages of a finished map: odometry alone; matches with maps seen shortly before, no
/// cycle closed; cycles closed as they came; the document itself. The second and the third are
/// worked out anew from its local maps, which takes as long as mapping them took.
std::vector<CorrectionStage> correction_stages(const pipeline::Config& config,
                                               const storage::MapDocument& document);

/// Draws them as stage_NAME.png into an existing directory, each with the local maps laid where the
/// stage has them and the global map that this gives. Throws std::runtime_error naming the file.
void write_stage_pictures(const std::filesystem::path& directory, const pipeline::Config& config,
                          const storage::MapDocument& document, const std::string& title);

}  // namespace topogeo::results
