#include "host_units.hpp"

#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <sstream>

namespace topogeo::cli {
namespace {

/// As sd_booted(3) has it.
constexpr const char* kSystemdRuns = "/run/systemd/system";

}  // namespace

std::vector<IdleUnit> idle_units() {
  std::error_code error;
  if (!std::filesystem::is_directory(kSystemdRuns, error)) return {};
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(
      ::popen("systemctl list-units --all --plain --no-legend --no-pager 'topogeo-*.service'"
              " 2> /dev/null",
              "r"),
      ::pclose);
  if (pipe == nullptr) return {};
  std::string listing;
  std::array<char, 4096> part{};
  while (const std::size_t read = std::fread(part.data(), 1, part.size(), pipe.get())) {
    listing.append(part.data(), read);
  }
  return idle_units(listing);
}

std::vector<IdleUnit> idle_units(std::string_view listing) {
  std::vector<IdleUnit> idle;
  std::istringstream lines{std::string(listing)};
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string name;
    std::string loaded;
    std::string active;
    std::string part;
    if (!(words >> name >> loaded >> active >> part)) continue;
    name = name.substr(0, name.rfind(".service"));
    const bool restarts = part.starts_with("auto-restart");
    if (restarts || active == "failed") idle.push_back({name, restarts});
  }
  return idle;
}

}  // namespace topogeo::cli
