// Settings of the content of report.json beyond counts and decisions.
#pragma once

#include "topogeo/support/config_schema.hpp"

namespace topogeo::pipeline {

struct ReportConfig {
  bool overlaps = false;  ///< overlap sets and solutions of each stop, see stop_overlaps.hpp
};

/// Declares the section `report`, which is not part of the fingerprint: it changes no map.
void describe(ReportConfig& config, support::ConfigSchema& schema);

}  // namespace topogeo::pipeline
