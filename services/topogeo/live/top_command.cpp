// topogeo top: the search pool while it works.
#include <iostream>
#include <memory>

#include <sys/ioctl.h>
#include <unistd.h>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/matching/matcher.hpp"
#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/support/version.hpp"

#include "commands.hpp"
#include "common/domain_view.hpp"
#include "live/pool_table.hpp"

namespace topogeo::cli {
namespace {

struct TopOptions {
  DomainView view;
  bool watch = false;
  bool once = false;
  bool json = false;
};

constexpr int kIndent = 2;
constexpr int kOneLine = -1;  // of nlohmann

/// Size of the terminal; lines of 80 columns for any other output.
TextSize space_for(bool terminal) {
  winsize window{};
  if (!terminal || ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &window) != 0 || window.ws_col == 0) {
    return {};
  }
  return {std::max<std::size_t>(kColumns, window.ws_col), window.ws_row};
}

int show_pool(const TopOptions& options) {
  const messaging::Participant participant = join(options.view, "topogeo top", "status");
  const messaging::Reader<msg::WorkerStatus> workers(participant);
  const messaging::Reader<msg::ServiceStatus> services(participant);
  messaging::EventLoop loop;
  PoolTable table(std::string(support::kVersion), localization::matcher_fingerprint());
  loop.add<msg::WorkerStatus>(
      workers,
      [&](const msg::WorkerStatus& status, const messaging::SampleInfo& info) {
        table.update(status, info, PoolTable::Clock::now());
      },
      [&](const messaging::SampleInfo& info) { table.remove_worker(info); });
  loop.add<msg::ServiceStatus>(
      services,
      [&](const msg::ServiceStatus& status, const messaging::SampleInfo& info) {
        table.update(status, info, PoolTable::Clock::now());
      },
      [&](const messaging::SampleInfo& info) { table.remove_service(info); });

  const bool redraw = !options.once && !options.json && ::isatty(STDOUT_FILENO) != 0;
  const auto show = [&] {
    const PoolTable::Clock::time_point now = PoolTable::Clock::now();
    table.forget_silent(now);
    if (options.json) {
      std::cout << table.json(now, options.once ? kIndent : kOneLine);
      return;
    }
    if (redraw) std::cout << "\x1b[H\x1b[J";  // home, clear to the end
    std::cout << table.text(now, space_for(redraw));
    if (!options.once && !redraw) std::cout << '\n';
  };
  DomainView view = options.view;
  view.watch = !options.once;
  const Collected collected = collect_and_show(
      view, loop, [&] { return table.workers(); }, show);
  if (collected.found || !options.once) return service::kOk;
  if (options.json) show();
  std::cerr << "topogeo: " << nothing_alive(options.view, "search worker")
            << "; `ga_worker --slots N` on any machine of the network starts one"
            << collected.reason << '\n';
  return service::kFailure;
}

}  // namespace

void add_top_command(command_line::Command& app, int& exit_code) {
  command_line::Command* command = app.add_subcommand(
      "top", "Watch the search pool at work: load, tasks, queues and faults, until Ctrl-C");
  auto options = std::make_shared<TopOptions>();
  add_domain_options(*command, options->view);
  add_watch_flags(*command, options->watch, options->once, "the default");
  command->add_flag("--json", options->json,
                    "for programs: an object, on a line of its own twice a second without --once");
  command->footer(
      "LOAD is the busy share of the slots, QUEUE the tasks that a worker has in hand, FAULTS "
      "what\n"
      "its status counts. Below, for each robot: OPEN tasks without answer, SENT/s tasks given to\n"
      "workers, WORKERS it uses, those LOST, tasks RESENT, and the OWN ones that its localizer\n"
      "solved by itself.");
  command->callback([options, &exit_code] { exit_code = show_pool(*options); });
}

}  // namespace topogeo::cli
