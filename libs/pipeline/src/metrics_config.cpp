#include "topogeo/pipeline/metrics_config.hpp"

namespace topogeo::pipeline {

void describe(MetricsConfig& config, support::ConfigSchema& schema) {
  constexpr std::uint32_t kLargest = 65000;  // leaves room for the ports of all services behind it
  schema.add("metrics.port", &config.port, 0, kLargest, "",
             "HTTP port of the sensor gateway's metrics for Prometheus; the other services use the "
             "next ports; 0: no metrics");
  schema.add("metrics.address", &config.address,
             "address of these ports; 0.0.0.0 admits other hosts, without password or encryption");
  schema.leave_out_of_fingerprint("metrics");
}

}  // namespace topogeo::pipeline
