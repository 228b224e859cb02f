#include "common/host_processes.hpp"

#include <algorithm>
#include <charconv>
#include <optional>
#include <sstream>
#include <string_view>
#include <system_error>

#include <unistd.h>

#include "topogeo/messaging/participant.hpp"
#include "topogeo/service/service_names.hpp"
#include "topogeo/support/host.hpp"
#include "topogeo/support/process_stat.hpp"

namespace topogeo::cli {
namespace {

constexpr std::string_view kPackagePrefix = "topogeo-";

/// Strings that each end with a zero byte.
std::vector<std::string> strings(const std::string& bytes) {
  std::vector<std::string> strings;
  std::istringstream input(bytes);
  for (std::string one; std::getline(input, one, '\0');) strings.push_back(one);
  return strings;
}

/// The service of a program; packages call it "topogeo-local-mapper". Empty: none.
std::string service_of(const std::string& program) {
  std::string name = std::filesystem::path(program).filename().string();
  if (name.starts_with(kPackagePrefix)) {
    name.erase(0, kPackagePrefix.size());
    std::ranges::replace(name, '-', '_');
  }
  return std::ranges::find(service::kServiceNames, name) == service::kServiceNames.end() ? ""
                                                                                         : name;
}

/// The value of "--name VALUE" or "--name=VALUE"; the last one counts.
std::optional<std::string> option(const std::vector<std::string>& words, const std::string& name) {
  std::optional<std::string> value;
  for (std::size_t i = 1; i < words.size(); ++i) {
    if (words[i] == name && i + 1 < words.size()) value = words[i + 1];
    if (words[i].starts_with(name + "=")) value = words[i].substr(name.size() + 1);
  }
  return value;
}

/// A variable of the environment of a process; empty: it has none, or this user may not read it.
std::string variable_of(const std::filesystem::path& process, const std::string& name) {
  for (const std::string& variable : strings(support::process_file(process / "environ"))) {
    if (variable.starts_with(name + "=")) return variable.substr(name.size() + 1);
  }
  return {};
}

std::uint32_t domain_of(const std::vector<std::string>& words,
                        const std::filesystem::path& process) {
  std::string text = option(words, "--domain").value_or("");
  if (text.empty()) text = variable_of(process, "TOPOGEO_DOMAIN");
  std::uint32_t domain = 0;
  std::from_chars(text.data(), text.data() + text.size(), domain);
  return domain;
}

std::string robot_of_process(const std::vector<std::string>& words,
                             const std::filesystem::path& process) {
  for (const char* name : {"--robot-id", "--robot"}) {
    if (const auto robot = option(words, name)) return *robot;
  }
  return variable_of(process, "TOPOGEO_ROBOT");
}

/// Reads state and age from /proc/PID/stat, see proc(5). False: the process has ended.
bool read_stat(HostProcess& process, const std::filesystem::path& folder, double up_s) {
  std::string state;
  support::process_stat(folder) >> state;
  const std::optional<std::uint64_t> start = support::process_start_ticks(folder);
  if (!start || state == "Z" || state == "X") return false;
  process.stopped = state == "T" || state == "t";
  process.age_s = up_s - static_cast<double>(*start) / static_cast<double>(::sysconf(_SC_CLK_TCK));
  return true;
}

/// Whether the process shares the namespace of that kind, "net" or "uts", with this one.
bool shares(const char* kind, const std::filesystem::path& proc,
            const std::filesystem::path& process) {
  std::error_code error;
  const auto own = std::filesystem::read_symlink(proc / "self/ns" / kind, error);
  if (error) return true;
  const auto other = std::filesystem::read_symlink(process / "ns" / kind, error);
  return error || own == other;
}

/// Whether the statuses of the process have the host name of this one. A container has a UTS
/// namespace of its own, but on the network of the host the same name, which its engine also puts
/// into HOSTNAME. A unit of systemd with ProtectHostname has such a namespace, but no HOSTNAME.
bool has_this_host_name(const std::filesystem::path& proc, const std::filesystem::path& process) {
  if (shares("uts", proc, process)) return true;
  const std::string name = variable_of(process, "HOSTNAME");
  return name.empty() ? shares("pid", proc, process) : name == support::host_name();
}

/// The last number of the line NSpid of /proc/PID/status, see proc(5). 0: there is none.
pid_t innermost_pid(const std::filesystem::path& process) {
  std::istringstream lines(support::process_file(process / "status"));
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("NSpid:")) continue;
    std::istringstream numbers(line.substr(line.find(':') + 1));
    pid_t last = 0;
    for (pid_t number = 0; numbers >> number;) last = number;
    return last;
  }
  return 0;
}

}  // namespace

std::vector<HostProcess> host_processes(const std::filesystem::path& proc) {
  std::vector<HostProcess> found;
  double up_s = 0.0;
  std::istringstream(support::process_file(proc / "uptime")) >> up_s;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(proc, error)) {
    const std::string name = entry.path().filename().string();
    HostProcess process;
    const auto [end, number] = std::from_chars(name.data(), name.data() + name.size(), process.pid);
    if (number != std::errc() || end != name.data() + name.size()) continue;
    const std::vector<std::string> words = strings(support::process_file(entry.path() / "cmdline"));
    if (words.empty()) continue;
    process.service = service_of(words[0]);
    if (process.service.empty() || !read_stat(process, entry.path(), up_s) ||
        !shares("net", proc, entry.path()) || !has_this_host_name(proc, entry.path())) {
      continue;
    }
    const pid_t innermost = innermost_pid(entry.path());
    process.own_pid = innermost != 0 ? innermost : process.pid;
    process.domain = domain_of(words, entry.path());
    process.partition = option(words, "--partition").value_or(messaging::kDefaultPartition);
    process.robot = robot_of_process(words, entry.path());
    found.push_back(std::move(process));
  }
  std::ranges::sort(found, {}, &HostProcess::pid);
  return found;
}

}  // namespace topogeo::cli
