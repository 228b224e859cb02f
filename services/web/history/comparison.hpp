// Compares two versions of a map for pages.
#pragma once

#include <memory>
#include <string>

#include "topogeo/planning/grid_sources.hpp"
#include "topogeo/storage/map_document.hpp"

#include "server/json_values.hpp"

namespace topogeo::web {

struct NamedVersion {
  std::string name;  ///< of a snapshot; empty: the current map
  std::shared_ptr<const storage::MapDocument> map;
};

struct Comparison {
  Json json;        ///< answer of GET /api/compare, without "picture"
  std::string png;  ///< result of difference_png()
};

/// Takes as long as building both grids. Throws like difference().
Comparison compared(const NamedVersion& before, const NamedVersion& after,
                    const planning::ScanGridConfig& config);

}  // namespace topogeo::web
