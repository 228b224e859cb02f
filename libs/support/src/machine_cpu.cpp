#include "topogeo/support/machine_cpu.hpp"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string_view>
#include <vector>

#include <sched.h>

#include "topogeo/support/format.hpp"

namespace topogeo::support {
namespace {

namespace fs = std::filesystem;

constexpr double kPercent = 0.01;

std::string first_line_of(const fs::path& file) {
  std::ifstream input(file);
  std::string line;
  std::getline(input, line);
  return line;
}

std::uint32_t usable_processors() {
  cpu_set_t set;
  CPU_ZERO(&set);
  if (::sched_getaffinity(0, sizeof set, &set) != 0) return 1;
  return static_cast<std::uint32_t>(std::max(1, CPU_COUNT(&set)));
}

/// "some avg10=98.55 avg60=89.59 ...", the share in percent.
std::optional<double> pressure_in(const fs::path& file) {
  constexpr std::string_view kTen = "some avg10=";
  const std::string line = first_line_of(file);
  double percent = 0.0;
  if (!line.starts_with(kTen) || !(std::istringstream(line.substr(kTen.size())) >> percent)) {
    return std::nullopt;
  }
  return percent * kPercent;
}

/// Folder and name of a group: of version 2 below `root` or `root`/unified, of version 1 below
/// `root`/cpu or the like.
struct Group {
  bool unified = false;
  fs::path root;
  fs::path name;
};

std::vector<Group> groups_of_process(const MachineCpuSources& sources) {
  std::vector<Group> groups;
  std::ifstream file(sources.proc / "self/cgroup");  // "4:cpu,cpuacct:/name", version 2 "0::/name"
  for (std::string line; std::getline(file, line);) {
    const std::size_t first = line.find(':');
    const std::size_t second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    const fs::path name = fs::path(line.substr(second + 1)).relative_path();
    if (controllers.empty()) {
      groups.push_back({true, sources.cgroup, name});
      groups.push_back({true, sources.cgroup / "unified", name});
    } else if (("," + controllers + ",").find(",cpu,") != std::string::npos) {
      groups.push_back({false, sources.cgroup / controllers, name});
      if (controllers != "cpu") groups.push_back({false, sources.cgroup / "cpu", name});
    }
  }
  return groups;
}

/// CPUs that one folder of a group allows: "80000 100000", or "max 100000" for no quota.
std::optional<double> quota_in(const fs::path& folder, bool unified) {
  std::string text = first_line_of(folder / "cpu.max");
  if (!unified) {
    text = first_line_of(folder / "cpu.cfs_quota_us") + " " +
           first_line_of(folder / "cpu.cfs_period_us");
  }
  double quota_us = 0.0;
  double period_us = 0.0;
  if (!(std::istringstream(text) >> quota_us >> period_us)) return std::nullopt;
  if (quota_us <= 0.0 || period_us <= 0.0) return std::nullopt;
  return quota_us / period_us;
}

void read_throttling(const fs::path& folder, MachineCpu& machine) {
  machine.quota_periods = 0;
  machine.throttled_periods = 0;
  std::ifstream file(folder / "cpu.stat");
  std::string name;
  std::uint64_t value = 0;
  while (file >> name >> value) {
    if (name == "nr_periods") machine.quota_periods = value;
    if (name == "nr_throttled") machine.throttled_periods = value;
  }
}

/// The smallest quota of the process's group and all groups above it.
void read_quota(const MachineCpuSources& sources, MachineCpu& machine) {
  for (const Group& group : groups_of_process(sources)) {
    for (fs::path below = group.name;; below = below.parent_path()) {
      const std::optional<double> quota = quota_in(group.root / below, group.unified);
      if (quota && (!machine.quota || *quota < *machine.quota)) {
        machine.quota = quota;
        read_throttling(group.root / below, machine);
      }
      if (below.empty()) break;
    }
  }
}

}  // namespace

double MachineCpu::available() const {
  return std::min(static_cast<double>(processors), quota.value_or(processors));
}

MachineCpu read_machine_cpu(const MachineCpuSources& sources) {
  MachineCpu machine;
  machine.processors = usable_processors();
  std::istringstream(first_line_of(sources.proc / "loadavg")) >> machine.load;
  machine.pressure_share = pressure_in(sources.proc / "pressure/cpu");
  read_quota(sources, machine);
  return machine;
}

std::string describe(const MachineCpu& machine) {
  std::string text =
      fmt::format("{} processor{}", machine.processors, machine.processors == 1 ? "" : "s");
  if (machine.quota) text += fmt::format(", a quota of {:.2g} CPUs", *machine.quota);
  text += fmt::format(", load {:.1f}", machine.load);
  if (machine.pressure_share) {
    text += fmt::format(", some thread waits for a CPU {:.0f} % of the time",
                        *machine.pressure_share / kPercent);
  }
  return text;
}

}  // namespace topogeo::support
