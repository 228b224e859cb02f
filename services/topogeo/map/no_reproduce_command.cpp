// Replaces `topogeo reproduce` (research/reproduce) if TOPOGEO_RESEARCH is off.
#include <memory>
#include <string>
#include <vector>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/service/service_options.hpp"

#include "commands.hpp"

namespace topogeo::cli {

void add_reproduce_command(command_line::Command& app, int& /*exit_code*/) {
  command_line::Command* command = app.add_subcommand(
      "reproduce", "Not built into this program (CMake option TOPOGEO_RESEARCH)");
  auto names = std::make_shared<std::vector<std::string>>();
  command->add_option("names", *names, "any")->type_name("NAME");
  command->callback([names] {
    throw service::UsageError(
        "reproduce: not built into this program, configure it with -DTOPOGEO_RESEARCH=ON");
  });
}

}  // namespace topogeo::cli
