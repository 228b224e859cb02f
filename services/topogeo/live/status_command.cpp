// topogeo status: the services on a domain, their state and their inputs.
#include <chrono>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <unistd.h>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/service/service_names.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/support/host.hpp"

#include "commands.hpp"
#include "common/domain_view.hpp"
#include "common/host_processes.hpp"
#include "common/host_units.hpp"
#include "live/status_table.hpp"
#include "live/unheard_services.hpp"

namespace topogeo::cli {
namespace {

/// Limited for --watch, because querying the units starts another program.
constexpr std::chrono::seconds kUnitsPeriod{2};

struct StatusOptions {
  DomainView view;
  std::string service;  ///< only this name; empty: all
  std::string host;     ///< only this host; empty: all
  std::vector<std::string> expected;
  bool verbose = false;
  bool json = false;
};

void print(const StatusOptions& options, const StatusTable& table,
           StatusTable::Clock::time_point now) {
  if (options.json) {
    std::cout << table.json(now);
  } else if (options.verbose || !options.service.empty()) {
    std::cout << table.details(now);
  } else {
    std::cout << table.text(now);
  }
}

int show_status(const StatusOptions& options) {
  const messaging::Participant participant = join(options.view, "topogeo status", "status", true);
  messaging::EventLoop loop;
  StatusTable table;
  table.expect(options.expected);
  const bool asks_this_host = options.host.empty() || options.host == support::host_name();
  const bool of_this_host = options.service.empty() && asks_this_host;
  UnheardServices unheard(options.view.domain, options.view.partition);
  StatusTable::Clock::time_point units_due{};
  const auto show_units = [&](StatusTable::Clock::time_point now) {
    if (!of_this_host || now < units_due) return;
    table.show_units(host_units().idle);
    units_due = now + kUnitsPeriod;
  };
  const auto show_unheard = [&](StatusTable::Clock::time_point now) {
    if (options.host.empty()) unheard.discovered(participant.discovered(), now);
    if (asks_this_host) unheard.running(host_processes(), support::host_name());
    std::vector<UnheardService> silent = unheard.list(now);
    std::erase_if(silent, [&](const UnheardService& one) {
      return !options.service.empty() && one.name != options.service;
    });
    table.show_unheard(std::move(silent));
  };
  loop.add<msg::ServiceStatus>(
      messaging::Reader<msg::ServiceStatus>(participant),
      [&](const msg::ServiceStatus& status, const messaging::SampleInfo& info) {
        unheard.heard(status, info, StatusTable::Clock::now());
        if (!options.service.empty() && status.service() != options.service.c_str()) return;
        if (!options.host.empty() && status.host() != options.host.c_str()) return;
        table.update(status, info, StatusTable::Clock::now());
      },
      [&](const messaging::SampleInfo& info) { table.remove(info); });

  const bool redraw = options.view.watch && !options.json && ::isatty(STDOUT_FILENO) != 0;
  const Collected collected = collect_and_show(
      options.view, loop,
      // A service that is expected or was just discovered is awaited as long as the first one.
      [&] {
        const StatusTable::Clock::time_point now = StatusTable::Clock::now();
        if (options.host.empty()) unheard.discovered(participant.discovered(), now);
        return table.missing().empty() && !unheard.may_come(now) ? table.size() : 0;
      },
      [&] {
        const StatusTable::Clock::time_point now = StatusTable::Clock::now();
        table.forget(now);
        show_unheard(now);
        show_units(now);
        if (redraw) std::cout << "\x1b[H\x1b[J";  // home, clear to the end
        print(options, table, now);
        if (options.view.watch && !redraw) std::cout << '\n';
      });
  if (collected.found)
    return table.healthy(StatusTable::Clock::now()) ? service::kOk : service::kFailure;
  show_unheard(StatusTable::Clock::now());
  show_units(StatusTable::Clock::now());
  if (!options.expected.empty() || table.has_idle_units() || table.has_unheard()) {
    if (!options.view.watch) print(options, table, StatusTable::Clock::now());
    return service::kFailure;
  }
  if (options.json && !options.view.watch) std::cout << "[]\n";
  const std::string what = options.service.empty() ? "service" : "'" + options.service + "'";
  std::cerr << "topogeo: " << nothing_alive(options.view, what, participant.discovered())
            << collected.reason << '\n';
  return service::kFailure;
}

}  // namespace

void add_status_command(command_line::Command& app, int& exit_code) {
  command_line::Command* command =
      app.add_subcommand("status", "Show the services on the network: state, input, faults");
  auto options = std::make_shared<StatusOptions>();
  const std::vector<std::string> services(service::kServiceNames.begin(),
                                          service::kServiceNames.end());
  command->add_option("service", options->service, "only services of this name, with all details")
      ->completed_by(services)
      ->type_name("SERVICE");
  add_view_options(*command, options->view);
  command
      ->add_option("--host", options->host, "only services of this host, for example $(hostname)")
      ->type_name("HOST");
  command
      ->add_option("--expect", options->expected,
                   "services that must be there, separated by commas; one that is not there is "
                   "listed as missing")
      ->completed_by(services)
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check([](const std::string& name) {
        return name.empty() ? std::string("expected names of services, got an empty one")
                            : std::string();
      })
      ->type_name("SERVICE,...")
      ->excludes(command->get_option("service"));
  command->add_flag("--verbose", options->verbose, "details of all services: counters, versions");
  command->add_flag("--json", options->json, "for programs: fields as in idl/status.idl");
  command->footer(
      "INPUT/s is the rate of what a service works on (scans, local maps, tasks, poses) over the\n"
      "last 5 s, AGE the time since the last one. A service without status for 1.5 s is silent, "
      "one\n"
      "that ended without an order is lost, one that gets nothing of an input that another one "
      "sends\n"
      "is deaf. One that is discovered, or runs on this host, but sends no status is silent, too.\n"
      "Services that ended earlier are listed only if they are expected or are systemd units of\n"
      "this host.\n"
      "Exit code: 0 all services are well, 1 some are failed, lost, silent, deaf, missing or not\n"
      "running, or there are none.");
  command->callback([options, &exit_code] { exit_code = show_status(*options); });
}

}  // namespace topogeo::cli
