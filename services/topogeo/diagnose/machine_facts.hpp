// The facts about the machine that `topogeo doctor` examines.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/support/machine_cpu.hpp"

namespace topogeo::cli {

/// A multicast test on a network interface that is up and supports it, or on the loopback interface
/// if there is no other.
struct MulticastProbe {
  std::string interface;
  std::string error;  ///< reason why the packet did not come back; empty if it did
  bool loopback = false;
};

struct SerialPortFacts {
  std::string path;
  bool exists = false;
  bool accessible = false;  ///< whether `user` may open it
  std::string group;        ///< owner of the port
  bool named = false;       ///< true: the devices file names it; false: it was found in /dev
  std::string user{};       ///< who opens it: the user of the gateway's unit, else of this program
};

struct MachineFacts {
  std::string user;

  // ports: Object Management Group, DDSI-RTPS 2.3, chapter 9.6.1.1
  std::uint32_t domain = 0;
  std::uint32_t discovery_port = 0;        ///< UDP, shared by all programs of the domain
  std::string discovery_port_error;        ///< why it cannot be shared; empty: it can
  std::string discovery_port_owner;        ///< program that has it, if known
  std::uint32_t used_ports = 0;            ///< number of the programs' own ports in use
  std::uint32_t first_ephemeral_port = 0;  ///< first port that the system assigns to any program
  std::uint32_t last_ephemeral_port = 0;

  // network
  std::string found_by;  ///< variable that makes multicast unnecessary; empty: it is needed
  bool secured = false;  ///< with TOPOGEO_SECURITY, which discovery servers do not support
  std::vector<MulticastProbe> multicast;
  bool multicast_route = false;
  std::uint64_t receive_buffer_bytes = 0;  ///< default of a UDP socket, net.core.rmem_default

  // shared memory
  bool uses_shared_memory = false;
  std::string shared_memory_error;  ///< why no file can be made there; empty: it can
  std::uint64_t shared_memory_free_bytes = 0;
  std::uint64_t dead_segments = 0;
  std::uint64_t dead_bytes = 0;

  // devices
  std::string devices_error;  ///< why the named file cannot be used
  std::vector<SerialPortFacts> serial_ports;
  bool udev_rule = false;      ///< the rule of the package is installed
  bool modem_manager = false;  ///< a program that takes serial ports for modems runs

  // disk
  std::string map_folder;
  std::string map_folder_error;  ///< why it cannot be written; empty: it can
  std::string closed_folder;     ///< folder above the map folder that `user` cannot access
  std::uint64_t disk_free_bytes = 0;

  support::MachineCpu cpu;

  // memory and limits
  std::uint64_t memory_available_bytes = 0;
  std::optional<std::uint64_t> memory_limit_bytes;  ///< of the container, unit or shell
  std::uint64_t open_files_limit = 0;
};

/// Sources of the facts. Tests use other paths.
struct FactSources {
  std::filesystem::path proc = "/proc";
  std::filesystem::path cgroup = "/sys/fs/cgroup";
  std::filesystem::path shared_memory = "/dev/shm";
  std::filesystem::path dev = "/dev";
  std::vector<std::filesystem::path> udev_rules{"/etc/udev/rules.d", "/lib/udev/rules.d"};
};

struct MachineQuestions {
  std::uint32_t domain = 0;
  std::filesystem::path map_folder;
  std::optional<std::filesystem::path> devices;  ///< devices file; none: ports found in /dev
  FactSources sources;
};

/// Queries the system. Sends a packet to each interface, and writes and removes a file in the map
/// folder and in shared memory.
MachineFacts gather_machine_facts(const MachineQuestions& questions);

}  // namespace topogeo::cli
