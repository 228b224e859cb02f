// A host that accepts no packets does not delay others. Runs in a network of its own, where an
// address at the far end of a cable never answers; skipped when none can be created.
#include "packets/host_sockets.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include <arpa/inet.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sched.h>
#include <sys/socket.h>
#include <sys/types.h>

namespace topogeo::messaging {
namespace {

using Address = std::array<std::uint8_t, 4>;
constexpr Address kHere = {127, 0, 0, 1};
constexpr std::uint16_t kPort = 7999;
constexpr std::chrono::milliseconds kPatienceOfSender{100};
const std::vector<std::uint8_t> kPacket(1400, 7);

/// In two parts, as some middleware has it.
Sending send(HostSockets& sockets, std::vector<std::uint8_t> packet, const Address& to,
             std::uint16_t port = kPort) {
  const std::size_t half = packet.size() / 2;
  const std::array<iovec, 2> parts = {
      {{packet.data(), half}, {packet.data() + half, packet.size() - half}}};
  return sockets.send(parts, to, port, kPatienceOfSender);
}

/// A separate network for this thread during its lifetime.
class OwnNetwork {
 public:
  OwnNetwork() : machine_(::open("/proc/thread-self/ns/net", O_RDONLY | O_CLOEXEC)) {
    made_ = machine_.get() >= 0 && ::unshare(CLONE_NEWNET) == 0 &&
            std::system(
                "ip link set lo up && ip link add name near0 type veth peer name far0 && "
                "ip address add 10.3.0.1/24 dev near0 && ip link set near0 up && ip link set far0 "
                "up") == 0;
  }
  OwnNetwork(const OwnNetwork&) = delete;
  OwnNetwork& operator=(const OwnNetwork&) = delete;
  ~OwnNetwork() {
    if (machine_.get() >= 0) static_cast<void>(::setns(machine_.get(), CLONE_NEWNET));
  }
  [[nodiscard]] bool made() const { return made_; }

 private:
  support::FileDescriptor machine_;
  bool made_ = false;
};

class Receiver {
 public:
  Receiver() : socket_(::socket(AF_INET, SOCK_DGRAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(kPort);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    // NOLINTNEXTLINE(*-reinterpret-cast): the interface of sockets
    const auto* name = reinterpret_cast<const sockaddr*>(&address);
    bound_ = ::bind(socket_.get(), name, sizeof address) == 0;
  }
  [[nodiscard]] bool bound() const { return bound_; }
  bool take() {
    std::array<std::uint8_t, 2000> packet{};
    return ::recv(socket_.get(), packet.data(), packet.size(), MSG_DONTWAIT) ==
           static_cast<ssize_t>(kPacket.size());
  }

 private:
  support::FileDescriptor socket_;
  bool bound_ = false;
};

TEST(HostSockets, AHostThatTakesNothingKeepsNoOtherWaiting) {
  const OwnNetwork network;
  if (!network.made()) GTEST_SKIP() << "no network can be made";
  Receiver receiver;
  ASSERT_TRUE(receiver.bound());
  // Smaller than the kernel's queue during address resolution.
  HostSockets sockets({.most_hosts = 8, .queue_bytes = 20'000});
  int dropped = 0;
  for (int round = 0; round < 300; ++round) {
    for (std::uint8_t nobody = 2; nobody < 5; ++nobody) {
      const Address address = {10, 3, 0, nobody};
      dropped += send(sockets, kPacket, address) == Sending::kDropped ? 1 : 0;
    }
    ASSERT_EQ(send(sockets, kPacket, kHere), Sending::kDone) << round;
    ASSERT_TRUE(receiver.take()) << round;
  }
  EXPECT_GT(dropped, 0);
  EXPECT_EQ(sockets.hosts(), 4U);
}

TEST(HostSockets, KeepsABoundedNumberOfSockets) {
  HostSockets sockets({.most_hosts = 3});
  Receiver receiver;
  for (int round = 0; round < 2; ++round) {
    for (std::uint8_t host = 1; host < 10; ++host) {
      static_cast<void>(send(sockets, kPacket, {127, 0, 0, host}, 9));
    }
  }
  EXPECT_EQ(sockets.hosts(), 3U);
}

TEST(HostSockets, TellsWhatCannotBeSent) {
  HostSockets sockets;
  const std::vector<std::uint8_t> too_large(70'000);
  EXPECT_EQ(send(sockets, too_large, kHere), Sending::kFailed);
}

}  // namespace
}  // namespace topogeo::messaging
