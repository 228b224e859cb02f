#include "topogeo/pipeline/metrics_config.hpp"

namespace topogeo::pipeline {

void describe(MetricsConfig& config, support::ConfigSchema& schema) {
  constexpr std::uint32_t kLargest = 65000;  // leaves room for the ports of all services behind it
  schema.add("metrics.port", &config.port, 0, kLargest, "",
             "HTTP port where the sensor gateway gives its figures to Prometheus, the other "
             "services at the next ones; 0: none does");
  schema.add("metrics.address", &config.address,
             "address they listen on; 0.0.0.0 lets other hosts in, with neither password nor "
             "encryption");
  schema.leave_out_of_fingerprint("metrics");
}

}  // namespace topogeo::pipeline
