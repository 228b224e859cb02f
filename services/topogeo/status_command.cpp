// topogeo status: one line for each service that lives on the domain.
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/signal_stop.hpp"
#include "topogeo/service/service_options.hpp"

#include "commands.hpp"
#include "service_table.hpp"

namespace topogeo::cli {
namespace {

// Services tell every half second; discovery takes the rest.
constexpr std::chrono::milliseconds kListen{1200};

struct StatusOptions {
  std::uint32_t domain = 0;
  std::string partition = messaging::kAnyPartition;
  std::filesystem::path profiles_file;
  bool watch = false;
};

/// False when there is none.
bool print_table(const ServiceTable& table, const StatusOptions& options) {
  for (const msg::ServiceStatus* row : table.rows()) std::cout << status_line(*row) << '\n';
  std::cout << std::flush;
  if (!table.rows().empty()) return true;
  std::cerr << "topogeo: no service is alive on domain " << options.domain << ", partition '"
            << options.partition << "'\n";
  return false;
}

int show_status(const StatusOptions& options) {
  messaging::ParticipantOptions participant_options;
  participant_options.domain = options.domain;
  participant_options.partition = options.partition;
  participant_options.name = "topogeo status";
  participant_options.profiles_file = options.profiles_file;
  const messaging::Participant participant(participant_options);
  const messaging::Reader<msg::ServiceStatus> reader(participant);
  messaging::EventLoop loop;
  const messaging::SignalStop signals([&](int) { loop.stop(); });
  ServiceTable table;
  loop.add<msg::ServiceStatus>(
      reader,
      [&](const msg::ServiceStatus& status, const messaging::SampleInfo& info) {
        if (status.state() != msg::kServiceStopped) table.update(status, info);
      },
      [&](const messaging::SampleInfo& info) { table.remove(info); });

  bool found = false;
  do {
    if (loop.run_for(kListen)) break;
    if (options.watch) std::cout << '\n';
    found = print_table(table, options);
  } while (options.watch);
  return found ? service::kOk : service::kFailure;
}

}  // namespace

void add_status_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("status", "Print one line for each live service");
  auto options = std::make_shared<StatusOptions>();
  command->add_option("--domain", options->domain, "DDS domain")
      ->check(CLI::Range(0U, 232U))
      ->capture_default_str();
  command->add_option("--partition", options->partition, "only services of this partition; *: all")
      ->capture_default_str();
  command->add_option("--profiles", options->profiles_file, "QoS profiles instead of built in")
      ->type_name("FILE");
  command->add_flag("--watch", options->watch, "again and again until Ctrl-C");
  command->callback([options, &exit_code] { exit_code = show_status(*options); });
}

}  // namespace topogeo::cli
