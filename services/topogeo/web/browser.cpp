#include "web/browser.hpp"

#include <cstdlib>
#include <stdexcept>
#include <vector>

#include <fcntl.h>
#include <spawn.h>
#include <unistd.h>

#include "topogeo/support/log.hpp"
#include "topogeo/support/secret_file.hpp"

namespace topogeo::cli {
namespace {

void write_page_to(const std::string& link, const std::filesystem::path& page) {
  support::write_secret_file(
      page,
      "<!DOCTYPE html>\n<meta charset=\"utf-8\">\n<meta http-equiv=\"refresh\" content=\"0;url=" +
          link + "\">\n<a href=\"" + link + "\">topogeo</a>\n");
}

}  // namespace

std::string operator_link(const std::string& links) {
  const std::string line = links.substr(0, links.find('\n'));
  const std::size_t begin = line.find("http");
  return begin == std::string::npos ? std::string() : line.substr(begin);
}

void open_in_browser(const std::string& link, const std::filesystem::path& page) {
  // NOLINTBEGIN(concurrency-mt-unsafe): nothing changes the environment
  const bool has_screen =
      std::getenv("DISPLAY") != nullptr || std::getenv("WAYLAND_DISPLAY") != nullptr;
  // NOLINTEND(concurrency-mt-unsafe)
  if (!has_screen || link.empty()) return;
  try {
    write_page_to(link, page);
  } catch (const std::runtime_error& error) {
    spdlog::warn("no browser is opened: {}", error.what());
    return;
  }
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  for (const int output : {STDOUT_FILENO, STDERR_FILENO}) {
    posix_spawn_file_actions_addopen(&actions, output, "/dev/null", O_WRONLY, 0);
  }
  std::string program = "xdg-open";
  std::string argument = "file://" + std::filesystem::absolute(page).string();
  std::vector<char*> arguments = {program.data(), argument.data(), nullptr};
  pid_t child = -1;
  static_cast<void>(
      posix_spawnp(&child, program.c_str(), &actions, nullptr, arguments.data(), environ));
  posix_spawn_file_actions_destroy(&actions);
}

}  // namespace topogeo::cli
