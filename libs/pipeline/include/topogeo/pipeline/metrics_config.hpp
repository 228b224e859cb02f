// Settings of the metrics of services for Prometheus.
#pragma once

#include <cstdint>
#include <string>

#include "topogeo/support/config_schema.hpp"

namespace topogeo::pipeline {

struct MetricsConfig {
  std::uint32_t port = 0;  ///< of the first service, the others follow; 0: no metrics
  std::string address = "127.0.0.1";
};

/// Declares the keys. They are not part of the fingerprint: no result depends on them.
void describe(MetricsConfig& config, support::ConfigSchema& schema);

}  // namespace topogeo::pipeline
