// Floods hosts with packets of strangers until SIGTERM: garbage, and participants that do not
// exist. It listens to the multicast announcements of domain 0.
//
//   stranger_flood ADDRESS...
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <iostream>
#include <thread>
#include <utility>
#include <vector>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include "garbage.hpp"

namespace topogeo::test {
namespace {

constexpr std::uint16_t kFirstPort = 7400;
constexpr std::uint64_t kPorts = 32;
/// Packets sent at once, with a pause of 2 ms: some five thousand packets a second.
constexpr int kAtOnce = 10;

volatile std::sig_atomic_t g_stopped = 0;

int flood(const std::vector<const char*>& addresses) {
  Announcements announcements(kFirstPort);
  std::vector<Packet> real;
  while (real.size() < 10 && g_stopped == 0) {
    Packet packet = announcements.next();
    if (packet.size() > 60) real.push_back(std::move(packet));
  }
  if (real.empty()) return 0;
  Garbage garbage(real, true);
  support::Random random(11);
  const int socket = ::socket(AF_INET, SOCK_DGRAM, 0);
  std::uint64_t sent = 0;
  while (g_stopped == 0) {
    for (int n = 0; n < kAtOnce; ++n, ++sent) {
      const Packet packet = sent % 10 == 0 ? garbage.next_stranger() : garbage.next();
      sockaddr_in to{};
      to.sin_family = AF_INET;
      to.sin_port = htons(static_cast<std::uint16_t>(kFirstPort + 10 + random.below(kPorts)));
      ::inet_pton(AF_INET, addresses[sent % addresses.size()], &to.sin_addr);
      ::sendto(socket, packet.data(), packet.size(), 0, reinterpret_cast<const sockaddr*>(&to),
               sizeof to);  // NOLINT: their interface
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));  // pacing, see kAtOnce
  }
  ::close(socket);
  std::cout << sent << " packets\n";
  return 0;
}

}  // namespace
}  // namespace topogeo::test

int main(int argc, char** argv) {
  if (argc < 2) {
    std::cerr << "usage: stranger_flood ADDRESS...\n";
    return 2;
  }
  std::signal(SIGTERM, [](int) { topogeo::test::g_stopped = 1; });
  return topogeo::test::flood({argv + 1, argv + argc});
}
