#include "topogeo/pipeline/report_config.hpp"

namespace topogeo::pipeline {

void describe(ReportConfig& config, support::ConfigSchema& schema) {
  schema.add(
      "report.overlaps", &config.overlaps,
      "report.json holds for each stop the earlier ones that see the same, and the solutions "
      "of a search in each that it was matched with; 20 ms for each of these");
  schema.leave_out_of_fingerprint("report");
}

}  // namespace topogeo::pipeline
