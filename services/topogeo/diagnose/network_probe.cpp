#include "diagnose/network_probe.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <fstream>
#include <iterator>
#include <memory>
#include <sstream>
#include <system_error>
#include <utility>

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "topogeo/support/file_descriptor.hpp"
#include "topogeo/support/format.hpp"

namespace topogeo::cli {
namespace {

namespace fs = std::filesystem;

constexpr int kHexadecimal = 16;
/// Timeout of a packet that never leaves the machine.
constexpr int kEchoPatience_ms = 1000;

std::string last_error() {
  return std::generic_category().message(errno);
}

support::FileDescriptor udp_socket() {
  return support::FileDescriptor(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
}

sockaddr_in address_of(std::uint32_t ip_network_order, std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = ip_network_order;
  return address;
}

const sockaddr* generic(const sockaddr_in& address) {
  return reinterpret_cast<const sockaddr*>(&address);  // NOLINT: the interface of sockets
}

/// Why a packet to the group does not come back on the interface with this address.
std::string why_no_echo(in_addr interface) {
  in_addr group{};
  ::inet_pton(AF_INET, kDiscoveryGroup, &group);
  const support::FileDescriptor receiver = udp_socket();
  const support::FileDescriptor sender = udp_socket();
  if (!receiver.is_open() || !sender.is_open()) return last_error();
  const sockaddr_in any = address_of(htonl(INADDR_ANY), 0);
  sockaddr_in bound{};
  socklen_t size = sizeof bound;
  if (::bind(receiver.get(), generic(any), sizeof any) != 0 ||
      ::getsockname(receiver.get(), reinterpret_cast<sockaddr*>(&bound), &size) != 0) {  // NOLINT
    return last_error();
  }
  ip_mreq membership{};
  membership.imr_multiaddr = group;
  membership.imr_interface = interface;
  if (::setsockopt(receiver.get(), IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof membership) !=
      0) {
    return "cannot join the group: " + last_error();
  }
  if (::setsockopt(sender.get(), IPPROTO_IP, IP_MULTICAST_IF, &interface, sizeof interface) != 0) {
    return "cannot send on it: " + last_error();
  }
  const sockaddr_in to = address_of(group.s_addr, ntohs(bound.sin_port));
  const std::array<char, 4> packet = {'t', 'e', 's', 't'};
  if (::sendto(sender.get(), packet.data(), packet.size(), 0, generic(to), sizeof to) < 0) {
    return "cannot send to the group: " + last_error();
  }
  pollfd waiting{receiver.get(), POLLIN, 0};
  return ::poll(&waiting, 1, kEchoPatience_ms) == 1 ? "" : "nothing comes back";
}

/// "socket:[12345]" for each socket at a port.
std::vector<std::string> sockets_at(std::uint32_t port, const fs::path& proc) {
  std::vector<std::string> sockets;
  for (const UdpSocket& socket : udp_sockets(proc)) {
    if (socket.port == port && !socket.inode.empty()) {
      sockets.push_back("socket:[" + socket.inode + "]");
    }
  }
  return sockets;
}

bool has_one_of(const fs::path& descriptors, const std::vector<std::string>& sockets) {
  std::error_code error;
  for (fs::directory_iterator entry(descriptors, error), end; !error && entry != end;
       entry.increment(error)) {
    std::error_code gone;
    if (std::ranges::count(sockets, fs::read_symlink(entry->path(), gone).string()) > 0) {
      return true;
    }
  }
  return false;
}

}  // namespace

std::vector<UdpSocket> udp_sockets(const fs::path& proc) {
  std::vector<UdpSocket> sockets;
  for (const char* table : {"net/udp", "net/udp6"}) {
    std::ifstream input(proc / table);
    std::string line;
    std::getline(input, line);  // titles
    while (std::getline(input, line)) {
      // "  12: 0100007F:1CE8 00000000:0000 07 ..."
      std::istringstream words(line);
      const std::vector<std::string> fields{std::istream_iterator<std::string>(words), {}};
      constexpr std::size_t kLocal = 1;
      constexpr std::size_t kInode = 9;
      if (fields.size() <= kLocal) continue;
      const std::string& local = fields[kLocal];
      const std::size_t colon = local.find(':');
      if (colon == std::string::npos) continue;
      UdpSocket socket;
      const char* const end = local.data() + local.size();
      if (std::from_chars(local.data() + colon + 1, end, socket.port, kHexadecimal).ec !=
          std::errc()) {
        continue;
      }
      if (fields.size() > kInode) socket.inode = fields[kInode];
      sockets.push_back(std::move(socket));
    }
  }
  return sockets;
}

std::string why_port_cannot_be_shared(std::uint32_t port) {
  const support::FileDescriptor socket = udp_socket();
  const int yes = 1;
  const sockaddr_in any = address_of(htonl(INADDR_ANY), static_cast<std::uint16_t>(port));
  if (!socket.is_open() ||
      ::setsockopt(socket.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes) != 0 ||
      ::bind(socket.get(), generic(any), sizeof any) != 0) {
    return last_error();
  }
  return {};
}

std::string owner_of_udp_port(std::uint32_t port, const fs::path& proc) {
  const std::vector<std::string> sockets = sockets_at(port, proc);
  std::error_code error;
  for (fs::directory_iterator entry(proc, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string process = entry->path().filename().string();
    if (process.find_first_not_of("0123456789") != std::string::npos ||
        !has_one_of(entry->path() / "fd", sockets)) {
      continue;
    }
    std::ifstream input(entry->path() / "comm");
    std::string name;
    std::getline(input, name);
    return fmt::format("{} ({})", name, process);
  }
  return {};
}

std::vector<MulticastProbe> probe_multicast() {
  ifaddrs* list = nullptr;
  if (::getifaddrs(&list) != 0) return {};
  const std::unique_ptr<ifaddrs, decltype(&::freeifaddrs)> owner(list, &::freeifaddrs);
  std::vector<MulticastProbe> probes;
  for (const bool loopback : {false, true}) {
    for (const ifaddrs* one = list; one != nullptr; one = one->ifa_next) {
      if (one->ifa_addr == nullptr || one->ifa_addr->sa_family != AF_INET) continue;
      if ((one->ifa_flags & IFF_UP) == 0) continue;
      if (((one->ifa_flags & IFF_LOOPBACK) != 0) != loopback) continue;
      // Linux lacks the flag on loopback, where multicast works all the same.
      if (!loopback && (one->ifa_flags & IFF_MULTICAST) == 0) continue;
      const auto* address = reinterpret_cast<const sockaddr_in*>(one->ifa_addr);  // NOLINT
      probes.push_back({one->ifa_name, why_no_echo(address->sin_addr), loopback});
    }
    if (!probes.empty()) break;
  }
  return probes;
}

std::uint64_t receive_buffer_of_a_socket() {
  const support::FileDescriptor socket = udp_socket();
  int bytes = 0;
  socklen_t size = sizeof bytes;
  if (::getsockopt(socket.get(), SOL_SOCKET, SO_RCVBUF, &bytes, &size) != 0) return 0;
  return static_cast<std::uint64_t>(bytes);
}

bool has_multicast_route(const fs::path& route_table) {
  in_addr group{};
  ::inet_pton(AF_INET, kDiscoveryGroup, &group);
  std::ifstream input(route_table);
  std::string line;
  std::getline(input, line);  // titles
  while (std::getline(input, line)) {
    // "eth0 0000FEA9 00000000 0001 0 0 1000 0000FFFF ...": addresses in network order
    std::istringstream words(line);
    const std::vector<std::string> fields{std::istream_iterator<std::string>(words), {}};
    constexpr std::size_t kDestination = 1;
    constexpr std::size_t kMask = 7;
    if (fields.size() <= kMask) continue;
    const auto number = [](const std::string& text) {
      return static_cast<std::uint32_t>(std::stoul(text, nullptr, kHexadecimal));
    };
    if ((group.s_addr & number(fields[kMask])) == number(fields[kDestination])) return true;
  }
  return false;
}

}  // namespace topogeo::cli
