#include "topogeo/pipeline/odometry_source.hpp"

namespace topogeo::pipeline {

void describe(OdometrySource& source, support::ConfigSchema& schema) {
  schema.add("odometry.source", &source,
             {{"auto", OdometrySource::kAuto},
              {"recorded", OdometrySource::kRecorded},
              {"laser", OdometrySource::kLaser}},
             "odometry of a log that `topogeo map` and `topogeo localize` read. recorded: that of "
             "the log; laser: from its scans alone; auto: from the scans if the log has no "
             "odometry, or if that stays at one pose while the scans move");
}

}  // namespace topogeo::pipeline
