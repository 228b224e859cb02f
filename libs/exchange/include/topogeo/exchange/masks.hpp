// Zones as masks of Nav2's costmap filters (docs/exchange.md, "Masks").
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "topogeo/exchange/output_file.hpp"
#include "topogeo/planning/occupancy_grid.hpp"
#include "topogeo/planning/zones.hpp"

namespace topogeo::exchange {

struct MaskFiles {
  std::vector<OutputFile> files;
  Notes notes;
};

/// PATH_keepout and PATH_speed, each an image and a YAML file, in mode raw, on the cells of `frame`
/// or, if that is rotated, on unrotated cells around it. A cell that a zone touches belongs to it:
/// keepout 100 in no-go zones, speed the allowed speed of the slowest zone; 0 elsewhere. A comment
/// of the YAML file has the values for CostmapFilterInfo.
MaskFiles mask_files(const std::filesystem::path& path, const planning::GridFrame& frame,
                     std::span<const planning::DrawnZone> zones);

}  // namespace topogeo::exchange
