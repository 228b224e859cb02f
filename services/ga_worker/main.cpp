// Works on the match tasks of any robot: genetic search for the relative pose of two local maps.
#include <CLI/CLI.hpp>

#include "topogeo/service/service.hpp"
#include "topogeo/service/service_options.hpp"

#include "ga_worker_service.hpp"

int main(int argc, char** argv) {
  using namespace topogeo;  // NOLINT(google-build-using-namespace)
  ga_worker::WorkerOptions options;
  return service::run_service(
      argc, argv, "ga_worker", "Works on the match tasks of any robot.",
      [&](CLI::App& app) {
        constexpr std::uint32_t kMostSlots = 256;
        app.add_option("--slots", options.slots, "tasks that it works on at the same time")
            ->check(CLI::Range(std::uint32_t{1}, kMostSlots))
            ->capture_default_str();
        app.add_option("--worker-id", options.worker_id,
                       "unique name, up to 64 bytes (default: host and process id)");
      },
      [&](const service::Setup& setup) {
        service::Service service(setup, true);
        ga_worker::GaWorkerService worker(service, options);
        service.run();
        worker.drain();
      });
}
