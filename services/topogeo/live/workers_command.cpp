// topogeo workers: the search workers on the domain and their current tasks.
#include <iostream>
#include <memory>

#include <unistd.h>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/matching/matcher.hpp"
#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/support/version.hpp"

#include "commands.hpp"
#include "common/domain_view.hpp"
#include "live/worker_table.hpp"

namespace topogeo::cli {
namespace {

struct WorkersOptions {
  DomainView view;
  bool verbose = false;
  bool json = false;
};

int show_workers(const WorkersOptions& options) {
  const messaging::Participant participant = join(options.view, "topogeo workers", "status");
  const messaging::Reader<msg::WorkerStatus> reader(participant);
  messaging::EventLoop loop;
  WorkerTable table(std::string(support::kVersion), localization::matcher_fingerprint());
  loop.add<msg::WorkerStatus>(
      reader,
      [&](const msg::WorkerStatus& status, const messaging::SampleInfo& info) {
        table.update(status, info, WorkerTable::Clock::now());
      },
      [&](const messaging::SampleInfo& info) { table.remove(info); });

  const bool redraw = options.view.watch && !options.json && ::isatty(STDOUT_FILENO) != 0;
  const auto show = [&] {
    const WorkerTable::Clock::time_point now = WorkerTable::Clock::now();
    table.forget_silent(now);
    if (redraw) std::cout << "\x1b[H\x1b[J";  // home, clear to the end
    if (options.json) {
      std::cout << table.json(now);
    } else {
      std::cout << (options.verbose ? table.details(now) : table.text(now));
    }
    if (options.view.watch && !redraw) std::cout << '\n';
  };
  const Collected collected = collect_and_show(
      options.view, loop, [&] { return table.size(); }, show);
  if (collected.found || options.view.watch) return service::kOk;
  if (options.json) std::cout << "[]\n";
  std::cerr << "topogeo: " << nothing_alive(options.view, "search worker")
            << "; `ga_worker --slots N` on any machine of the network starts one"
            << collected.reason << '\n';
  return service::kFailure;
}

}  // namespace

void add_workers_command(command_line::Command& app, int& exit_code) {
  command_line::Command* command =
      app.add_subcommand("workers", "List the search workers on the network and their load");
  auto options = std::make_shared<WorkersOptions>();
  add_view_options(*command, options->view);
  command->add_flag("--verbose", options->verbose,
                    "details: process, version, tasks in hand, maps");
  command->add_flag("--json", options->json, "for programs: fields as in idl/status.idl");
  command->footer(
      "LOAD is the busy share of the slots since the last half second, DONE counts the tasks "
      "answered,\n"
      "FAILED those refused or failed.\n"
      "`ga_worker --slots N` on any machine of the network adds a worker, Ctrl-C there removes "
      "it.");
  command->callback([options, &exit_code] { exit_code = show_workers(*options); });
}

}  // namespace topogeo::cli
