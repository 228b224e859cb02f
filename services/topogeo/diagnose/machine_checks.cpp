#include "diagnose/machine_checks.hpp"

#include <array>

#include "topogeo/support/format.hpp"

#include "diagnose/network_probe.hpp"

namespace topogeo::cli {
namespace {

using enum Severity;
using Findings = std::vector<Finding>;

constexpr std::uint64_t kMega = 1'000'000;

// A program of a domain needs two ports, and the library tries a hundred pairs.
constexpr std::uint32_t kPortsOfPrograms = 200;
// Linux's default for a UDP socket. With less, a second local map of 64 KB, which the kernel counts
// twice, is lost.
constexpr std::uint64_t kLeastReceiveBuffer_bytes = 200'000;
// Room for the burst of local maps that a restarted localizer gets.
constexpr std::uint64_t kGoodReceiveBuffer_bytes = 1 * kMega;
// Each program creates a segment of 4 MB; a robot has seven programs.
constexpr std::uint64_t kLeastSharedMemory_bytes = 8 * kMega;
constexpr std::uint64_t kGoodSharedMemory_bytes = 48 * kMega;
// A day of driving makes a database of some hundred MB, and copying it needs the same again.
constexpr std::uint64_t kLeastDisk_bytes = 200 * kMega;
constexpr std::uint64_t kGoodDisk_bytes = 2'000 * kMega;
// A service takes up to 150 MB after a long drive, all services of a robot up to a GB.
constexpr std::uint64_t kLeastMemory_bytes = 256 * kMega;
constexpr std::uint64_t kGoodMemory_bytes = 1'000 * kMega;
// The start of all services hits any quota for some seconds of a long run.
constexpr double kMuchThrottled = 0.25;
// A search for loops keeps every CPU busy for a while with one thread each. A thread that wakes
// among three waits for two others.
constexpr double kCrowded = 3.0;
// A load is the mean of a minute. If its cause has ended, hardly any thread waits now.
constexpr double kMuchPressure = 0.5;
// Sockets, segments and locks of a service with a pool of a hundred peers.
constexpr std::uint64_t kLeastOpenFiles = 256;

std::string mega(std::uint64_t bytes) {
  return fmt::format("{:.0f} MB", static_cast<double>(bytes) / static_cast<double>(kMega));
}

Finding problem(std::string what, std::string why, std::string remedy) {
  return {"", kProblem, std::move(what), std::move(why), std::move(remedy)};
}

Finding hint(std::string what, std::string why, std::string remedy) {
  return {"", kHint, std::move(what), std::move(why), std::move(remedy)};
}

// --- ports

Findings check_ports(const MachineFacts& facts) {
  Findings found;
  if (!facts.discovery_port_error.empty()) {
    const std::string owner =
        facts.discovery_port_owner.empty() ? "" : ", " + facts.discovery_port_owner + " has it";
    found.push_back(problem(
        fmt::format("UDP port {} of domain {} cannot be opened: {}{}", facts.discovery_port,
                    facts.domain, facts.discovery_port_error, owner),
        "services discover each other there",
        fmt::format("end that program (`ss -ulnp sport = :{}` as root names it), or use another "
                    "--domain everywhere",
                    facts.discovery_port)));
  }
  if (facts.used_ports >= kPortsOfPrograms) {
    found.push_back(problem(
        fmt::format("{} UDP ports of domain {} are taken", facts.used_ports, facts.domain),
        "a program needs two, and no more than a hundred programs of a host find theirs",
        "use more --slots and fewer workers, or another --domain for some of the programs"));
  }
  if (facts.discovery_port <= facts.last_ephemeral_port &&
      facts.discovery_port + kPortsOfPrograms >= facts.first_ephemeral_port) {
    found.push_back(
        hint(fmt::format("the ports of domain {} are among those that the system gives to any "
                         "program ({} to {})",
                         facts.domain, facts.first_ephemeral_port, facts.last_ephemeral_port),
             "one of them may be taken when a service starts", "use a --domain below 100"));
  }
  return found;
}

std::string good_ports(const MachineFacts& facts) {
  return fmt::format("UDP {} of domain {} can be shared, {} ports are in use", facts.discovery_port,
                     facts.domain, facts.used_ports);
}

// --- multicast

constexpr const char* kFindEachOther = "services find each other by multicast";

std::string do_without(const MachineFacts& facts) {
  return fmt::format("or do without it: {} (deploy/README.md, \"How services find each other\")",
                     facts.secured ? "TOPOGEO_PEERS" : "ROS_DISCOVERY_SERVER");
}

std::string not_needed(const MachineFacts& facts) {
  return fmt::format("not needed: {} is set", facts.found_by);
}

Findings check_multicast(const MachineFacts& facts) {
  if (!facts.found_by.empty()) return {};
  if (facts.multicast.empty()) {
    return {problem("no network interface is up that can do multicast", kFindEachOther,
                    fmt::format("`ip link set dev IF up multicast on` (lo on a machine by itself), "
                                "{}",
                                do_without(facts)))};
  }
  Findings found;
  for (const MulticastProbe& probe : facts.multicast) {
    if (probe.error.empty()) continue;
    found.push_back(problem(
        fmt::format("{}: a packet to {} is lost: {}", probe.interface, kDiscoveryGroup,
                    probe.error),
        kFindEachOther,
        fmt::format("let UDP to 239.255.0.0/16 in and out (`nft list ruleset`, `iptables -L`), {}",
                    do_without(facts))));
  }
  return found;
}

std::string good_multicast(const MachineFacts& facts) {
  if (!facts.found_by.empty()) return not_needed(facts);
  std::string names;
  for (const MulticastProbe& probe : facts.multicast) names += " " + probe.interface;
  return fmt::format("packets to {} come back on{}", kDiscoveryGroup, names);
}

/// Announcements name their interface, so a machine by itself needs no route.
bool works_alone(const MachineFacts& facts) {
  return facts.multicast.size() == 1 && facts.multicast[0].loopback &&
         facts.multicast[0].error.empty();
}

Findings check_route(const MachineFacts& facts) {
  if (!facts.found_by.empty() || facts.multicast_route || works_alone(facts)) return {};
  const std::string interface = facts.multicast.empty() ? "lo" : facts.multicast[0].interface;
  return {problem(fmt::format("no route leads to {}", kDiscoveryGroup),
                  "the system may refuse to send the announcements of services",
                  fmt::format("`ip route add 239.255.0.0/16 dev {}`", interface))};
}

std::string good_route(const MachineFacts& facts) {
  if (facts.multicast_route) return fmt::format("there is one to {}", kDiscoveryGroup);
  if (facts.found_by.empty()) {
    return fmt::format("not needed: only {} is up", facts.multicast[0].interface);
  }
  return not_needed(facts);
}

// --- buffers

Findings check_buffers(const MachineFacts& facts) {
  if (facts.receive_buffer_bytes >= kGoodReceiveBuffer_bytes) return {};
  const std::string what = fmt::format("UDP sockets have {} KB to receive (net.core.rmem_default)",
                                       facts.receive_buffer_bytes / 1000);
  const std::string remedy =
      "`sysctl -w net.core.rmem_max=4194304 net.core.rmem_default=1048576`; in /etc/sysctl.d to "
      "keep it";
  if (facts.receive_buffer_bytes < kLeastReceiveBuffer_bytes) {
    return {problem(what, "local maps are lost and sent again and again", remedy)};
  }
  return {
      hint(what, "bursts of local maps are sent again, which takes time on a slow link", remedy)};
}

std::string good_buffers(const MachineFacts& facts) {
  return fmt::format("UDP sockets have {} KB to receive", facts.receive_buffer_bytes / 1000);
}

// --- shared memory

Findings check_shared_memory(const MachineFacts& facts) {
  if (!facts.uses_shared_memory) return {};
  const std::string without = "or go without: no TOPOGEO_DDS_PARTICIPANT=local";
  if (!facts.shared_memory_error.empty()) {
    return {problem(fmt::format("no file can be made there: {}", facts.shared_memory_error),
                    "services of a host exchange scans and maps there",
                    "mount a tmpfs, " + without)};
  }
  Findings found;
  if (facts.dead_segments > 0) {
    found.push_back(problem(
        fmt::format("{} segments ({}) of programs that were killed", facts.dead_segments,
                    mega(facts.dead_bytes)),
        "they fill /dev/shm, and other programs may wait for them",
        "any service that starts removes those of its user; others: `rm /dev/shm/fastrtps_*` while "
        "no service runs"));
  }
  if (facts.shared_memory_free_bytes < kLeastSharedMemory_bytes) {
    found.push_back(
        problem(fmt::format("{} are free", mega(facts.shared_memory_free_bytes)),
                "a service needs 4 MB there and fails without them",
                "`mount -o remount,size=256M /dev/shm` (containers: --shm-size), " + without));
  } else if (facts.shared_memory_free_bytes < kGoodSharedMemory_bytes) {
    found.push_back(hint(fmt::format("{} are free", mega(facts.shared_memory_free_bytes)),
                         "enough for some services, not for all of a robot with workers",
                         "`mount -o remount,size=256M /dev/shm` (containers: --shm-size)"));
  }
  return found;
}

std::string good_shared_memory(const MachineFacts& facts) {
  if (!facts.uses_shared_memory) return "not used, as TOPOGEO_DDS_PARTICIPANT is not `local`";
  return fmt::format("{} are free, nothing is left behind", mega(facts.shared_memory_free_bytes));
}

// --- devices

constexpr const char* kOrTheRule =
    "; for the user at the machine, deploy/udev/60-topogeo.rules in /etc/udev/rules.d does the "
    "same";

Findings check_serial_ports(const MachineFacts& facts) {
  if (!facts.devices_error.empty()) {
    return {problem(facts.devices_error, "the sensor gateway would not start",
                    "fix the file; `topogeo config --devices` prints a new one")};
  }
  Findings found;
  for (const SerialPortFacts& port : facts.serial_ports) {
    if (!port.exists) {
      found.push_back(
          problem(fmt::format("{} does not exist", port.path), "the file of devices names it",
                  "plug it in (`dmesg | tail`), or write the right port into the file"));
    } else if (!port.accessible) {
      found.push_back({"", port.named ? kProblem : kHint,
                       fmt::format("{} is closed to {}: it belongs to group {}", port.path,
                                   port.user.empty() ? facts.user : port.user, port.group),
                       "laser and base cannot be opened",
                       fmt::format("`usermod -aG {} {}` as root, then log in again{}", port.group,
                                   port.user.empty() ? facts.user : port.user,
                                   facts.udev_rule ? "" : kOrTheRule)});
    }
  }
  return found;
}

std::string good_serial_ports(const MachineFacts& facts) {
  if (facts.serial_ports.empty()) return "none is here or named";
  std::string paths;
  for (const SerialPortFacts& port : facts.serial_ports) paths += " " + port.path;
  return "can be opened:" + paths;
}

Findings check_udev_rule(const MachineFacts& facts) {
  if (facts.serial_ports.empty() || facts.udev_rule || !facts.modem_manager) return {};
  return {hint("ModemManager runs, and no rule keeps it from the serial ports",
               "it sends its commands to lasers and bases when they are plugged in",
               "install the package topogeo, or copy deploy/udev/60-topogeo.rules to "
               "/etc/udev/rules.d, then plug the device in again")};
}

std::string good_udev_rule(const MachineFacts& facts) {
  return facts.udev_rule ? "60-topogeo.rules is installed"
                         : "not needed: ModemManager does not run";
}

// --- disk and memory

Findings check_disk(const MachineFacts& facts) {
  if (facts.disk_free_bytes >= kGoodDisk_bytes) return {};
  const std::string what =
      fmt::format("{} are free for {}", mega(facts.disk_free_bytes), facts.map_folder);
  const std::string remedy = "make room, or let the map store write elsewhere (--out)";
  if (facts.disk_free_bytes < kLeastDisk_bytes) {
    return {problem(what, "the map cannot be stored when it is full", remedy)};
  }
  return {hint(what, "a map of many days needs more", remedy)};
}

std::string good_disk(const MachineFacts& facts) {
  return fmt::format("{} are free for {}", mega(facts.disk_free_bytes), facts.map_folder);
}

Findings check_map_folder(const MachineFacts& facts) {
  if (!facts.closed_folder.empty()) {
    return {problem(fmt::format("{} cannot look into {}", facts.user, facts.closed_folder),
                    "started by this user, the map store would not start",
                    "run it as the user of the services: `sudo -u topogeo topogeo doctor`")};
  }
  if (facts.map_folder_error.empty()) return {};
  return {problem(fmt::format("{} cannot write there: {}", facts.user, facts.map_folder_error),
                  "the map store would not start",
                  fmt::format("`install -d -o {} {}`, or --out with another folder", facts.user,
                              facts.map_folder))};
}

std::string good_map_folder(const MachineFacts& facts) {
  return fmt::format("{} can write to {}", facts.user, facts.map_folder);
}

// --- CPU

Findings check_cpu_time(const MachineFacts& facts) {
  const support::MachineCpu& cpu = facts.cpu;
  const std::string remedy =
      "end other programs, run workers (ga_worker), map store and page on another machine, or "
      "raise the quota: CPUQuota= of the unit, --cpus of the container";
  Findings found;
  const auto stopped = static_cast<double>(cpu.throttled_periods);
  if (cpu.quota && stopped >= kMuchThrottled * static_cast<double>(cpu.quota_periods) &&
      cpu.throttled_periods > 0) {
    found.push_back(hint(
        fmt::format("a quota of {:.2g} CPUs has stopped programs here in {:.0f} % of its periods",
                    *cpu.quota, 100.0 * stopped / static_cast<double>(cpu.quota_periods)),
        "stopped programs are late, even if the machine has idle CPUs", remedy));
  }
  const double threads = cpu.load / cpu.processors;
  const bool waits = !cpu.pressure_share || *cpu.pressure_share >= kMuchPressure;
  if (threads >= kCrowded && waits) {
    found.push_back(hint(
        fmt::format("the CPU is short: {:.1f} threads for each CPU ({})", threads, describe(cpu)),
        "scans and poses arrive late, and a robot that gets only late ones stops", remedy));
  }
  return found;
}

std::string good_cpu_time(const MachineFacts& facts) {
  return describe(facts.cpu);
}

// --- memory

Findings check_memory(const MachineFacts& facts) {
  Findings found;
  if (facts.memory_limit_bytes && *facts.memory_limit_bytes < kLeastMemory_bytes) {
    found.push_back(
        problem(fmt::format("a program here gets no more than {}", mega(*facts.memory_limit_bytes)),
                "a service that reaches the limit is killed",
                "raise MemoryMax of the unit, mem_limit of the container or `ulimit -v`"));
  }
  if (facts.memory_available_bytes < kLeastMemory_bytes) {
    found.push_back(problem(fmt::format("{} are free", mega(facts.memory_available_bytes)),
                            "the kernel kills a service when no memory is left",
                            "end other programs, or move workers and map store to a PC"));
  } else if (facts.memory_available_bytes < kGoodMemory_bytes) {
    found.push_back(hint(fmt::format("{} are free", mega(facts.memory_available_bytes)),
                         "all services of a robot take up to a GB after a long drive",
                         "move workers and map store to a PC"));
  }
  return found;
}

std::string good_memory(const MachineFacts& facts) {
  return fmt::format("{} are free", mega(facts.memory_available_bytes));
}

Findings check_open_files(const MachineFacts& facts) {
  if (facts.open_files_limit >= kLeastOpenFiles) return {};
  return {problem(fmt::format("a program may open {} files", facts.open_files_limit),
                  "each peer of a service takes some",
                  "`ulimit -n 4096`, LimitNOFILE= of the unit")};
}

std::string good_open_files(const MachineFacts& facts) {
  return fmt::format("a program may open {}", facts.open_files_limit);
}

constexpr auto kMachineChecks = std::to_array<Check<MachineFacts>>({
    {"ports", check_ports, good_ports},
    {"multicast", check_multicast, good_multicast},
    {"route", check_route, good_route},
    {"UDP buffers", check_buffers, good_buffers},
    {"shared memory", check_shared_memory, good_shared_memory},
    {"serial ports", check_serial_ports, good_serial_ports},
    {"udev rule", check_udev_rule, good_udev_rule},
    {"disk", check_disk, good_disk},
    {"map folder", check_map_folder, good_map_folder},
    {"CPU", check_cpu_time, good_cpu_time},
    {"memory", check_memory, good_memory},
    {"open files", check_open_files, good_open_files},
});

}  // namespace

std::span<const Check<MachineFacts>> machine_checks() {
  return kMachineChecks;
}

}  // namespace topogeo::cli
