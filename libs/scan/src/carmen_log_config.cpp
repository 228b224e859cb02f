#include "topogeo/scan/carmen_log_config.hpp"

#include "topogeo/support/config_schema.hpp"

namespace topogeo::scan {

void describe(CarmenLogOptions& options, support::ConfigSchema& schema) {
  schema.add("scan.range_max_m", &options.range_max_m, 0.5, 1000.0, "m",
             "readings at or above it mean that nothing came back; 50 to 82 by sensor in known "
             "logs");
  schema.add("scan.jump_s", &options.jump_s, 0.001, 1e9, "s",
             "a stamp of a log that is later than the one before by more than this must be "
             "confirmed by the next scan; otherwise it is taken to be wrong, not the rest of the "
             "log");
}

void check(const CarmenLogOptions& options) {
  support::check_ranges(options);
}

}  // namespace topogeo::scan
