#include "pool_options.hpp"

#include <chrono>
#include <string>

#include "topogeo/support/host.hpp"
#include "topogeo/support/version.hpp"

namespace topogeo::localizer {

namespace {

/// Unique among all processes that workers may remember.
std::string unique_client_id() {
  const auto start = std::chrono::system_clock::now().time_since_epoch();
  return support::process_name() + "-" +
         std::to_string(std::chrono::duration_cast<std::chrono::milliseconds>(start).count());
}

}  // namespace

RemotePoolOptions pool_options(const service::Service& service) {
  RemotePoolOptions options;
  options.robot_id = service.robot_id();
  options.client_id = unique_client_id();
  options.version = support::kVersion;
  options.config_fingerprint = service.setup().config.effective.fingerprint;
  options.stopping = [] { return service::Service::stopping(); };
  return options;
}

}  // namespace topogeo::localizer
