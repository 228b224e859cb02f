// topogeo status: one line for each service that lives on the domain.
#include <iostream>
#include <memory>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/service/service_options.hpp"

#include "commands.hpp"
#include "domain_view.hpp"
#include "service_table.hpp"

namespace topogeo::cli {
namespace {

int show_status(const DomainView& view) {
  const messaging::Participant participant = join(view, "topogeo status");
  const messaging::Reader<msg::ServiceStatus> reader(participant);
  messaging::EventLoop loop;
  ServiceTable table;
  loop.add<msg::ServiceStatus>(
      reader,
      [&](const msg::ServiceStatus& status, const messaging::SampleInfo& info) {
        if (status.state() != msg::kServiceStopped) table.update(status, info);
      },
      [&](const messaging::SampleInfo& info) { table.remove(info); });

  const bool found = look(
      view, loop, [&] { return !table.rows().empty(); },
      [&] {
        if (view.watch) std::cout << '\n';
        for (const msg::ServiceStatus* row : table.rows()) std::cout << status_line(*row) << '\n';
      });
  if (!found) std::cerr << "topogeo: " << nothing_alive(view, "service") << '\n';
  return found ? service::kOk : service::kFailure;
}

}  // namespace

void add_status_command(command_line::Command& app, int& exit_code) {
  command_line::Command* command =
      app.add_subcommand("status", "Print one line for each live service");
  auto view = std::make_shared<DomainView>();
  add_view_options(*command, *view);
  command->callback([view, &exit_code] { exit_code = show_status(*view); });
}

}  // namespace topogeo::cli
