#include "diagnose/machine_facts.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <sstream>
#include <string_view>
#include <system_error>

#include <grp.h>
#include <pwd.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include "topogeo/devices/network_address.hpp"
#include "topogeo/messaging/shared_memory.hpp"
#include "topogeo/support/atomic_file.hpp"

#include "device_config.hpp"
#include "diagnose/network_probe.hpp"
#include "diagnose/port_names.hpp"

namespace topogeo::cli {
namespace {

namespace fs = std::filesystem;

// Port numbers of a domain: the first one, the first program's offset, the distance of two domains.
constexpr std::uint32_t kFirstPort = 7400;
constexpr std::uint32_t kFirstOwnPort = 10;
constexpr std::uint32_t kPortsOfDomain = 250;

// Users created by the package: one runs the map store and commands, the other the gateway.
constexpr std::string_view kServicesUser = "topogeo";
constexpr const char* kGatewayUser = "topogeo-sensor-gateway";

std::string first_line(const fs::path& file) {
  std::ifstream input(file);
  std::string line;
  std::getline(input, line);
  return line;
}

std::uint64_t number_in(const fs::path& file) {
  std::uint64_t value = 0;
  std::istringstream(first_line(file)) >> value;
  return value;
}

std::string environment_text(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

std::string user_name() {
  const passwd* user = ::getpwuid(::geteuid());
  return user == nullptr ? std::to_string(::geteuid()) : user->pw_name;
}

void ask_for_ports(const FactSources& sources, MachineFacts& facts) {
  const std::uint32_t first = kFirstPort + kPortsOfDomain * facts.domain;
  facts.discovery_port = first;
  facts.discovery_port_error = why_port_cannot_be_shared(first);
  if (!facts.discovery_port_error.empty()) {
    facts.discovery_port_owner = owner_of_udp_port(first, sources.proc);
  }
  const std::vector<UdpSocket> sockets = udp_sockets(sources.proc);
  facts.used_ports =
      static_cast<std::uint32_t>(std::ranges::count_if(sockets, [&](const UdpSocket& socket) {
        return socket.port >= first + kFirstOwnPort && socket.port < first + kPortsOfDomain;
      }));
  std::istringstream range(first_line(sources.proc / "sys/net/ipv4/ip_local_port_range"));
  range >> facts.first_ephemeral_port >> facts.last_ephemeral_port;
}

/// Lists of hosts are separated by ';'.
bool names_hosts(const char* variable) {
  return environment_text(variable).find_first_not_of(';') != std::string::npos;
}

void ask_for_network(const FactSources& sources, MachineFacts& facts) {
  for (const char* variable : {"ROS_DISCOVERY_SERVER", "TOPOGEO_PEERS"}) {
    if (facts.found_by.empty() && names_hosts(variable)) facts.found_by = variable;
  }
  facts.secured = !environment_text("TOPOGEO_SECURITY").empty();
  facts.multicast = probe_multicast();
  facts.multicast_route = has_multicast_route(sources.proc / "net/route");
  facts.receive_buffer_bytes = number_in(sources.proc / "sys/net/core/rmem_default");
  // Older kernels do not show it in network namespaces.
  if (facts.receive_buffer_bytes == 0) facts.receive_buffer_bytes = receive_buffer_of_a_socket();
}

std::uint64_t free_bytes(const fs::path& folder) {
  struct statvfs space {};
  if (::statvfs(folder.c_str(), &space) != 0) return 0;
  return static_cast<std::uint64_t>(space.f_bavail) * space.f_frsize;
}

std::string why_not_writable(const fs::path& folder) {
  try {
    support::check_writable_directory(folder);
    return {};
  } catch (const std::exception& error) {
    return error.what();
  }
}

void ask_for_shared_memory(const FactSources& sources, MachineFacts& facts) {
  const std::string profile = environment_text("TOPOGEO_DDS_PARTICIPANT");
  facts.uses_shared_memory = profile == "local";
  std::error_code unknown;
  if (!fs::is_directory(sources.shared_memory, unknown)) {
    facts.shared_memory_error = sources.shared_memory.string() + ": is no folder";
    return;
  }
  facts.shared_memory_error = why_not_writable(sources.shared_memory);
  facts.shared_memory_free_bytes = free_bytes(sources.shared_memory);
  for (const messaging::DeadSegment& dead : messaging::find_dead_segments(sources.shared_memory)) {
    ++facts.dead_segments;
    facts.dead_bytes += dead.bytes;
  }
}

/// Whether a user may read and write a file, by owner, groups and mode.
bool can_open(const passwd& user, const struct stat& file) {
  constexpr mode_t kBoth = 06;
  if (user.pw_uid == file.st_uid) return (file.st_mode >> 6U & kBoth) == kBoth;
  std::array<gid_t, 64> groups{};
  int count = static_cast<int>(groups.size());
  if (::getgrouplist(user.pw_name, user.pw_gid, groups.data(), &count) < 0) return false;
  const bool in_group =
      std::find(groups.begin(), groups.begin() + count, file.st_gid) != groups.begin() + count;
  return (file.st_mode >> (in_group ? 3U : 0U) & kBoth) == kBoth;
}

SerialPortFacts serial_port(const fs::path& path, bool named) {
  SerialPortFacts facts;
  facts.path = path.string();
  facts.named = named;
  struct stat status {};
  facts.exists = ::stat(path.c_str(), &status) == 0;
  if (!facts.exists) return facts;
  facts.user = user_name();
  facts.accessible = ::access(path.c_str(), R_OK | W_OK) == 0;
  // Only the gateway may have the ports, not the other services.
  if (const passwd* gateway = ::getpwnam(kGatewayUser);
      gateway != nullptr && facts.user == kServicesUser) {
    facts.user = kGatewayUser;
    facts.accessible = can_open(*gateway, status);
  }
  const group* owner = ::getgrgid(status.st_gid);
  facts.group = owner == nullptr ? std::to_string(status.st_gid) : owner->gr_name;
  return facts;
}

bool runs(std::string_view program, const fs::path& proc) {
  std::error_code error;
  for (fs::directory_iterator entry(proc, error), end; !error && entry != end;
       entry.increment(error)) {
    if (first_line(entry->path() / "comm") == program) return true;
  }
  return false;
}

void ask_for_udev(const FactSources& sources, MachineFacts& facts) {
  std::error_code unknown;
  facts.udev_rule = std::ranges::any_of(sources.udev_rules, [&](const fs::path& folder) {
    return fs::exists(folder / "60-topogeo.rules", unknown);
  });
  facts.modem_manager = runs("ModemManager", sources.proc);
}

void ask_for_devices(const MachineQuestions& questions, MachineFacts& facts) {
  ask_for_udev(questions.sources, facts);
  if (questions.devices) {
    try {
      const sensor_gateway::DeviceConfig config = sensor_gateway::load_devices(*questions.devices);
      for (const std::string& port : {config.laser_port, config.base_port}) {
        if (port.empty() || devices::is_network_address(port)) continue;
        facts.serial_ports.push_back(serial_port(port, true));
      }
    } catch (const std::exception& error) {
      facts.devices_error = error.what();
    }
    return;
  }
  for (const fs::path& port : serial_ports(questions.sources.dev)) {
    facts.serial_ports.push_back(serial_port(port, false));
  }
}

/// A map folder is made on demand, so the nearest existing one above counts.
void ask_for_disk(const fs::path& map_folder, MachineFacts& facts) {
  std::error_code error;
  fs::path folder = fs::absolute(map_folder, error);
  if (error) folder = map_folder;  // the current folder was removed
  facts.map_folder = map_folder.string();
  bool closed = false;
  while (!fs::exists(folder, error) && folder.has_relative_path()) {
    closed = error == std::errc::permission_denied;
    if (error && !closed) facts.map_folder_error = folder.string() + ": " + error.message();
    folder = folder.parent_path();
  }
  if (closed) {
    facts.closed_folder = folder.string();
  } else if (facts.map_folder_error.empty()) {
    facts.map_folder_error = why_not_writable(folder);
  }
  facts.disk_free_bytes = free_bytes(folder);
}

/// The smallest effective limit, including those of all control groups above.
std::optional<std::uint64_t> memory_limit(const FactSources& sources) {
  std::optional<std::uint64_t> least;
  const auto take = [&](std::uint64_t bytes) { least = least ? std::min(*least, bytes) : bytes; };
  constexpr std::string_view kUnified = "0::";
  fs::path group;
  std::ifstream groups(sources.proc / "self/cgroup");
  for (std::string line; std::getline(groups, line);) {
    if (line.starts_with(kUnified)) group = line.substr(kUnified.size());
  }
  for (fs::path below = group.relative_path();; below = below.parent_path()) {
    const std::string limit = first_line(sources.cgroup / below / "memory.max");
    std::uint64_t bytes = 0;
    if (std::istringstream(limit) >> bytes) take(bytes);
    if (below.empty()) break;
  }
  rlimit address_space{};
  if (::getrlimit(RLIMIT_AS, &address_space) == 0 && address_space.rlim_cur != RLIM_INFINITY) {
    take(address_space.rlim_cur);
  }
  return least;
}

void ask_for_memory(const FactSources& sources, MachineFacts& facts) {
  constexpr std::uint64_t kKilobyte = 1024;
  constexpr std::string_view kAvailable = "MemAvailable:";
  std::ifstream memory(sources.proc / "meminfo");
  for (std::string line; std::getline(memory, line);) {
    if (!line.starts_with(kAvailable)) continue;
    std::istringstream(line.substr(kAvailable.size())) >> facts.memory_available_bytes;
    facts.memory_available_bytes *= kKilobyte;
  }
  facts.memory_limit_bytes = memory_limit(sources);
  rlimit files{};
  if (::getrlimit(RLIMIT_NOFILE, &files) == 0) facts.open_files_limit = files.rlim_cur;
}

}  // namespace

MachineFacts gather_machine_facts(const MachineQuestions& questions) {
  MachineFacts facts;
  facts.user = user_name();
  facts.domain = questions.domain;
  ask_for_ports(questions.sources, facts);
  ask_for_network(questions.sources, facts);
  ask_for_shared_memory(questions.sources, facts);
  ask_for_devices(questions, facts);
  ask_for_disk(questions.map_folder, facts);
  facts.cpu = support::read_machine_cpu({questions.sources.proc, questions.sources.cgroup});
  ask_for_memory(questions.sources, facts);
  return facts;
}

}  // namespace topogeo::cli
