#include "common/installed_settings.hpp"

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <system_error>

namespace topogeo::cli {
namespace {

/// Environment file of the package's units.
constexpr const char* kSettings = "/etc/topogeo/topogeo.env";
/// The other variables are for services only.
constexpr auto kOfCommands = std::to_array<const char*>(
    {"TOPOGEO_DOMAIN", "TOPOGEO_ROBOT", "TOPOGEO_SECURITY", "TOPOGEO_PEERS", "ROS_DISCOVERY_SERVER",
     "TOPOGEO_DDS_PARTICIPANT", "TOPOGEO_DDS_PROFILES"});
constexpr const char* kBlank = " \t\r";

/// Whether this program lies where packages install programs, not in a build tree.
bool is_installed() {
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  return !error && program.parent_path() == "/usr/libexec/topogeo";
}

std::string without_blanks(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(kBlank);
  if (begin == std::string::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlank) + 1 - begin);
}

std::string unquoted(const std::string& text) {
  const bool quoted =
      text.size() >= 2 && (text[0] == '"' || text[0] == '\'') && text.back() == text[0];
  return quoted ? text.substr(1, text.size() - 2) : text;
}

}  // namespace

std::map<std::string, std::string> environment_in(std::istream& file) {
  std::map<std::string, std::string> variables;
  for (std::string line; std::getline(file, line);) {
    line = without_blanks(line);
    const std::size_t sign = line.find('=');
    if (line.empty() || line[0] == '#' || line[0] == ';' || sign == std::string::npos) continue;
    variables[without_blanks(line.substr(0, sign))] =
        unquoted(without_blanks(line.substr(sign + 1)));
  }
  return variables;
}

void take_installed_settings() {
  if (!is_installed()) return;
  std::ifstream file(kSettings);
  std::error_code error;
  if (!file && std::filesystem::exists(kSettings, error)) {
    std::cerr << "topogeo: " << kSettings
              << " cannot be read by this user: its domain, robot and security settings are not "
                 "used; root and members of the group topogeo can read it\n";
  }
  const std::map<std::string, std::string> variables = environment_in(file);
  for (const char* const name : kOfCommands) {
    const auto found = variables.find(name);
    if (found != variables.end())
      ::setenv(name, found->second.c_str(), 0);  // NOLINT: no thread yet
  }
}

}  // namespace topogeo::cli
