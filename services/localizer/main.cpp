// Corrects the pose of every stop by matching its local map against earlier ones.
#include <CLI/CLI.hpp>

#include "topogeo/service/service.hpp"
#include "topogeo/service/service_options.hpp"

#include "localizer_service.hpp"

int main(int argc, char** argv) {
  using namespace topogeo;  // NOLINT(google-build-using-namespace)
  localizer::LocalizerOptions options;
  return service::run_service(
      argc, argv, "localizer", "Corrects the trajectory by matching local maps.",
      [&](CLI::App& app) {
        app.add_option("--wait-workers", options.wait_workers,
                       "search workers to wait for before the first step")
            ->capture_default_str();
        constexpr double kLongestWait_s = 3600.0;
        app.add_option("--wait-seconds", options.wait_s, "how long to wait for them at most")
            ->check(CLI::Range(0.0, kLongestWait_s))
            ->capture_default_str();
      },
      [&](const service::Setup& setup) {
        service::Service service(setup);
        const localizer::LocalizerService localizer(service, options);
        service.run();
      });
}
