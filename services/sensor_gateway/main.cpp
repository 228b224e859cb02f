// Gives the scans and odometry of a robot. Today's source is a log in CARMEN's format.
#include <string>
#include <utility>

#include <CLI/CLI.hpp>

#include "topogeo/service/replay_rate.hpp"
#include "topogeo/service/service.hpp"
#include "topogeo/service/service_options.hpp"

#include "log_gateway.hpp"

namespace {

using namespace topogeo;  // NOLINT(google-build-using-namespace)

struct OpenLog {
  scan::CarmenLogReader reader;
  std::uint64_t scans_total;
};

OpenLog open_log(const std::filesystem::path& path, const scan::CarmenLogOptions& options) {
  try {
    return {scan::CarmenLogReader(path, options), scan::count_scans(path)};
  } catch (const std::runtime_error& error) {
    throw service::BadInputError(error.what());
  }
}

}  // namespace

int main(int argc, char** argv) {
  sensor_gateway::GatewayOptions options;
  const auto add_options = [&](CLI::App& app) {
    app.add_option("--log", options.log, "log in CARMEN's format, plain or gzip")->required();
    app.add_option_function<std::string>(
           "--rate",
           [&](const std::string& text) {
             try {
               options.rate = service::parse_rate(text);
             } catch (const std::invalid_argument& error) {
               throw CLI::ValidationError("--rate", error.what());
             }
           },
           "realtime, lossless (as fast as the readers take it) or a factor of real time")
        ->default_str("lossless");
    app.add_option("--readers", options.readers, "readers of scans to wait for; 0: do not wait")
        ->check(CLI::Range(0, 100))
        ->capture_default_str();
    app.add_flag("--exit-at-end", options.exit_at_end, "end when the log has ended");
  };
  return service::run_service(argc, argv, "sensor_gateway",
                              "Replays the scans and odometry of a log.", add_options,
                              [&](const service::Setup& setup) {
                                OpenLog log = open_log(options.log, setup.config.config.log);
                                service::Service service(setup);
                                const sensor_gateway::LogGateway gateway(
                                    service, options, std::move(log.reader), log.scans_total);
                                service.run();
                              });
}
