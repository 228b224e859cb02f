#include "topogeo/scan/carmen_log_config.hpp"

#include "topogeo/support/config_schema.hpp"

namespace topogeo::scan {

void describe(CarmenLogOptions& options, support::ConfigSchema& schema) {
  schema.add("scan.range_max_m", &options.range_max_m, 0.5, 1000.0, "m",
             "readings of this range or more are no return; known logs use 50 to 82, depending on "
             "the sensor");
  schema.add("scan.range_scale", &options.range_scale, 0.1, 10.0, "",
             "metres of a range of 1 in the log: 0.3048 for feet, less than 1 for a laser that "
             "measures too much; scan.range_max_m is as in the log");
  schema.add("scan.detect_no_return", &options.detect_no_return,
             "some lasers report one value at the top of their ranges, such as 8.187 m, for no "
             "echo; true: it is found in the readings, and those at or above it are no return");
  schema.add("scan.jump_s", &options.jump_s, 0.001, 1e9, "s",
             "a stamp that lies more than this after the previous one must be confirmed by the "
             "next scan; otherwise this stamp is taken to be wrong, not the rest of the log");
}

void check(const CarmenLogOptions& options) {
  support::check_ranges(options);
}

}  // namespace topogeo::scan
