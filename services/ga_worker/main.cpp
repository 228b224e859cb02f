// Solves match tasks of any robot: genetic search for the relative pose of two local maps.
#include <string>
#include <string_view>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/search_pool/worker_name.hpp"
#include "topogeo/service/service.hpp"
#include "topogeo/service/service_options.hpp"

#include "ga_worker_service.hpp"

namespace topogeo::ga_worker {
namespace {

search_pool::SlotScheduling scheduling_of(std::string_view name) {
  if (name == "idle") return search_pool::SlotScheduling::kIdle;
  if (name == "batch") return search_pool::SlotScheduling::kBatch;
  return search_pool::SlotScheduling::kNormal;
}

}  // namespace
}  // namespace topogeo::ga_worker

int main(int argc, char** argv) {
  using namespace topogeo;  // NOLINT(google-build-using-namespace)
  ga_worker::WorkerOptions options;
  options.name = search_pool::default_name();
  std::string scheduling = "batch";
  service::ServiceOptions defaults;
  defaults.partition = messaging::kAnyPartition;
  return service::run_service(
      argc, argv, "ga_worker",
      "Solves the match tasks of every robot and run on the domain. --partition restricts it to "
      "the runs of one partition, --config to clients with the same configuration.",
      [&](command_line::Command& app) {
        constexpr std::uint32_t kMostSlots = 256;
        constexpr std::uint32_t kLeastMemory_mb = 8;
        constexpr std::uint32_t kMostMemory_mb = 65536;
        app.add_option("--slots", options.slots,
                       "tasks that are solved in parallel; default: one for each usable CPU")
            ->check(command_line::range(std::uint32_t{1}, kMostSlots))
            ->capture_default_str();
        app.add_option("--name", options.name, "display name, up to 24 bytes; need not be unique")
            ->check(search_pool::check_name)
            ->capture_default_str();
        app.add_option(
               "--memory-mb", options.memory_mb,
               "memory for local maps and data derived from them, at least 4 MB for each slot")
            ->check(command_line::range(kLeastMemory_mb, kMostMemory_mb))
            ->capture_default_str();
        app.add_option("--scheduling", scheduling,
                       "CPU scheduling of the searches: like other programs (normal), without "
                       "interrupting them (batch), only on an idle CPU (idle)")
            ->check(command_line::one_of({"normal", "batch", "idle"}))
            ->capture_default_str();
      },
      [&](const service::Setup& setup) {
        options.scheduling = ga_worker::scheduling_of(scheduling);
        options.worker_id = search_pool::make_worker_id(options.name);
        service::Setup of_worker = setup;
        of_worker.instance = options.worker_id;
        service::Service service(of_worker, true);
        ga_worker::GaWorkerService worker(service, options);
        service.run();
        worker.drain();
      },
      defaults);
}
