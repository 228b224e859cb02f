#include "common/host_units.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <sstream>

namespace topogeo::cli {
namespace {

/// Test of sd_booted(3).
constexpr const char* kSystemdRuns = "/run/systemd/system";
constexpr std::string_view kOfServices = ".service";
constexpr std::string_view kDiscoveryServer = "topogeo-discovery@";

using Properties = std::map<std::string, std::string, std::less<>>;

void add(const Properties& unit, HostUnits& units) {
  const auto value = [&](std::string_view name) {
    const auto found = unit.find(name);
    return found == unit.end() ? std::string() : found->second;
  };
  std::string name = value("Id");
  if (!name.ends_with(kOfServices)) return;
  name.resize(name.size() - kOfServices.size());
  const std::string state = value("ActiveState");
  const std::string restarts = value("NRestarts");
  // Between two starts the unit waits, and looks like a unit that is started for the first time.
  const bool starts_again = state == "activating" && !restarts.empty() && restarts != "0";
  if (starts_again || value("SubState").starts_with("auto-restart")) {
    units.idle.push_back({name, true});
  } else if (state == "failed") {
    units.idle.push_back({name, false});
  } else if (state == "active" && !name.starts_with(kDiscoveryServer)) {
    ++units.on_domain;
  }
}

}  // namespace

HostUnits host_units() {
  std::error_code error;
  if (!std::filesystem::is_directory(kSystemdRuns, error)) return {};
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(
      ::popen("systemctl show --no-pager --property=Id,ActiveState,SubState,NRestarts"
              " 'topogeo-*.service' 2> /dev/null",
              "r"),
      ::pclose);
  if (pipe == nullptr) return {};
  std::string properties;
  std::array<char, 4096> part{};
  while (const std::size_t read = std::fread(part.data(), 1, part.size(), pipe.get())) {
    properties.append(part.data(), read);
  }
  return host_units(properties);
}

HostUnits host_units(std::string_view properties) {
  HostUnits units;
  Properties unit;
  std::istringstream lines{std::string(properties)};
  for (std::string line; std::getline(lines, line);) {
    const std::size_t sign = line.find('=');
    if (line.empty()) {
      add(unit, units);
      unit.clear();
    } else if (sign != std::string::npos) {
      unit[line.substr(0, sign)] = line.substr(sign + 1);
    }
  }
  add(unit, units);
  std::ranges::sort(units.idle, {}, &IdleUnit::name);
  return units;
}

}  // namespace topogeo::cli
