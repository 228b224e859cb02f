#include "browser.hpp"

#include <cstdlib>
#include <vector>

#include <fcntl.h>
#include <spawn.h>
#include <unistd.h>

namespace topogeo::cli {

std::string operator_link(const std::string& links) {
  const std::string line = links.substr(0, links.find('\n'));
  const std::size_t begin = line.find("http");
  return begin == std::string::npos ? std::string() : line.substr(begin);
}

void open_in_browser(const std::string& link) {
  // NOLINTBEGIN(concurrency-mt-unsafe): nothing changes the environment
  const bool has_screen =
      std::getenv("DISPLAY") != nullptr || std::getenv("WAYLAND_DISPLAY") != nullptr;
  // NOLINTEND(concurrency-mt-unsafe)
  if (!has_screen || link.empty()) return;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  for (const int output : {STDOUT_FILENO, STDERR_FILENO}) {
    posix_spawn_file_actions_addopen(&actions, output, "/dev/null", O_WRONLY, 0);
  }
  std::string program = "xdg-open";
  std::string argument = link;
  std::vector<char*> arguments = {program.data(), argument.data(), nullptr};
  pid_t child = -1;
  static_cast<void>(
      posix_spawnp(&child, program.c_str(), &actions, nullptr, arguments.data(), environ));
  posix_spawn_file_actions_destroy(&actions);
}

}  // namespace topogeo::cli
