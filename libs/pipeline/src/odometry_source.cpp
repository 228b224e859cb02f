#include "topogeo/pipeline/odometry_source.hpp"

namespace topogeo::pipeline {

void describe(OdometrySource& source, support::ConfigSchema& schema) {
  schema.add("odometry.source", &source,
             {{"auto", OdometrySource::kAuto},
              {"recorded", OdometrySource::kRecorded},
              {"laser", OdometrySource::kLaser}},
             "odometry of a log, or of a laser without a base. recorded: that of the log; laser: "
             "from the scans alone; auto: from the scans if there is none, or if that of a log "
             "stays at one pose while the scans move");
}

}  // namespace topogeo::pipeline
