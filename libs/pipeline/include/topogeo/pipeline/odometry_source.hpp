// Where the odometry of a log comes from: the log, or its scans.
#pragma once

#include <cstdint>

#include "topogeo/support/config_schema.hpp"

namespace topogeo::pipeline {

enum class OdometrySource : std::uint8_t {
  kAuto = 0,      ///< the log's, unless it has none or that stands while the scans move
  kRecorded = 1,  ///< the log's
  kLaser = 2,     ///< from the scans, whatever the log says
};

/// Declares `odometry.source`.
void describe(OdometrySource& source, support::ConfigSchema& schema);

}  // namespace topogeo::pipeline
