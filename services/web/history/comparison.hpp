// What differs between two versions of a map, for pages.
#pragma once

#include <memory>
#include <string>

#include "topogeo/planning/grid_sources.hpp"
#include "topogeo/storage/map_document.hpp"

#include "server/json_values.hpp"

namespace topogeo::web {

struct NamedVersion {
  std::string name;  ///< of a snapshot; empty: the map of now
  std::shared_ptr<const storage::MapDocument> map;
};

struct Comparison {
  Json json;        ///< as GET /api/compare, without "picture"
  std::string png;  ///< as difference_png() makes it
};

/// Takes as long as the grids of both take. Throws like difference().
Comparison compared(const NamedVersion& before, const NamedVersion& after,
                    const planning::ScanGridConfig& config);

}  // namespace topogeo::web
