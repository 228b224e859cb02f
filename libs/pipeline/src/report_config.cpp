#include "topogeo/pipeline/report_config.hpp"

namespace topogeo::pipeline {

void describe(ReportConfig& config, support::ConfigSchema& schema) {
  schema.add(
      "report.overlaps", &config.overlaps,
      "report.json lists for each stop the earlier stops with the same view, and the solutions of "
      "a search in each stop that it was matched with; each search takes 20 ms");
  schema.leave_out_of_fingerprint("report");
}

}  // namespace topogeo::pipeline
