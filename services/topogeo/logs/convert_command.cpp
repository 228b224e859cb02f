// topogeo convert: converts a log to another format.
#include <filesystem>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/recording/convert.hpp"
#include "topogeo/recording/log_writer.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/support/format.hpp"

#include "commands.hpp"
#include "common/configuration.hpp"
#include "common/job.hpp"

namespace topogeo::cli {
namespace {

struct ConvertRequest {
  std::filesystem::path in;
  std::filesystem::path out;
  recording::ConvertOptions options;
};

int convert_log(const ConvertRequest& request) {
  recording::Conversion done;
  try {
    done = recording::convert(request.in, request.out, request.options);
  } catch (const std::invalid_argument& error) {
    throw service::UsageError(error.what());
  } catch (const std::runtime_error& error) {
    throw service::BadInputError(error.what());
  }
  print_notes(done.notes);
  for (const auto& [topic, messages] : done.left_out) {
    std::cerr << fmt::format("topogeo: left out: {} messages of {}\n", messages, topic);
  }
  std::cout << fmt::format("{}: {} scans, {} odometry, {} transforms\n", request.out.string(),
                           done.scans, done.odometry, done.transforms);
  return service::kOk;
}

}  // namespace

void add_convert_command(command_line::Command& app, int& exit_code) {
  command_line::Command* command =
      app.add_subcommand("convert", "Write a log in another format: CARMEN, .mcap, .db3, .bag");
  auto request = std::make_shared<ConvertRequest>();
  command->add_option("IN", request->in, recording::kLogFormats)->required()->type_name("IN");
  command
      ->add_option(
          "OUT", request->out,
          std::string("log to write, in the format of its ending: ") + recording::kWrittenLogs)
      ->check(recording::check_log_name)
      ->required()
      ->type_name("OUT");
  command
      ->add_option("--compression", request->options.compression,
                   "compression: none, lz4 or zstd for .mcap; none, lz4 or bz2 for .bag")
      ->default_str("zstd; none for a .bag")
      ->type_name("NAME");
  add_topic_options(*command, request->options.topics);
  command->footer(
      "Between recordings all laser scans, odometry and transforms are copied; the topic options\n"
      "choose what a CARMEN log is made of.");
  command->callback([request, &exit_code] { exit_code = convert_log(*request); });
}

}  // namespace topogeo::cli
