// topogeo record: writes the scans that a gateway publishes to a log that can be replayed.
#include <atomic>
#include <memory>
#include <optional>
#include <string>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/messaging/signal_stop.hpp"
#include "topogeo/recording/log_writer.hpp"
#include "topogeo/service/service_options.hpp"

#include "commands.hpp"
#include "common/domain_view.hpp"
#include "logs/recorder.hpp"

namespace topogeo::cli {
namespace {

/// Records until a signal. A signal during the construction of the recorder counts like a later
/// one.
void record(const RecordRequest& request) {
  std::optional<Recorder> recorder;
  std::atomic<Recorder*> made = nullptr;
  const messaging::SignalStop signals([&](int) {
    if (Recorder* const there = made.load()) there->stop();
  });
  recorder.emplace(request);
  made = &*recorder;
  if (messaging::SignalStop::received() != 0) recorder->stop();
  recorder->run();
}

}  // namespace

void add_record_command(command_line::Command& app, int& exit_code) {
  command_line::Command* command =
      app.add_subcommand("record",
                         "Record the scans of a sensor gateway as a log, with poses, graph and "
                         "grid if its format has them");
  auto request = std::make_shared<RecordRequest>();
  command
      ->add_option(
          "--out", request->out,
          std::string("log to write, in the format of its ending: ") + recording::kWrittenLogs)
      ->check(recording::check_log_name)
      ->required()
      ->type_name("FILE");
  add_robot_option(*command, request->robot_id, "robot of the scans");
  command
      ->add_option("--laser", request->laser,
                   "mounting of the laser to write into the log, m and rad (default: 0,0,0)")
      ->type_name("X,Y,YAW");
  add_domain_options(*command, request->view);
  command->footer(
      "Ends with the stream of the gateway or with Ctrl-C. Numbers are written with every digit, "
      "so "
      "that\na replay of the log gives the map of the recorded run, byte for byte.");
  command->callback([request, &exit_code] {
    record(*request);
    exit_code = service::kOk;
  });
}

}  // namespace topogeo::cli
