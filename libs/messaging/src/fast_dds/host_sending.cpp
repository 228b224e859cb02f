// Sends what goes to one host through a socket of its own (host_sockets.hpp). Fast DDS 2.9.1 sends
// everything through one socket that blocks, with a lock held that each writer of the process
// needs: two hosts that were switched off, or a stranger who announces himself at addresses that
// nobody has, stop all its messages for three seconds again and again, those within its host, too.
// Takes the place of a function of the library, which calls it through its symbol; should a library
// have no such function, nothing calls the one here.
#include "host_sending.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>

#include <asio/ip/udp.hpp>
#include <fastdds/rtps/common/Locator.h>
#include <fastrtps/utils/IPLocator.h>

#include "../packets/host_sockets.hpp"
#include "library_function.hpp"

namespace {

namespace messaging = topogeo::messaging;
namespace rtps = eprosima::fastrtps::rtps;
using std::chrono::microseconds;

/// Of a host that takes what it gets, but slowly: as long as a writer may block.
constexpr microseconds kLongestWait{100'000};

constexpr const char* kSendPacket =
    "_ZN8eprosima7fastdds4rtps21UDPTransportInterface4sendEPKhjRN4asio21basic_datagram_socketINS5_"
    "2ip3udpENS5_15any_io_executorEEERKNS_8fastrtps4rtps9Locator_tEbbRKNSt6chrono8durationIlSt5"
    "ratioILl1ELl1000000EEEE";

messaging::HostSockets& host_sockets() {
  static messaging::HostSockets all;
  return all;
}

/// A profile may name the interfaces that are used; their sockets are bound to them.
bool of_one_interface(const asio::ip::udp::socket& socket) {
  asio::error_code error;
  return !socket.local_endpoint(error).address().is_unspecified();
}

}  // namespace

// NOLINTNEXTLINE: the name of a member function of the library
extern "C" bool
topogeo_send_packet(void* transport, const std::uint8_t* packet, std::uint32_t size, asio::ip::udp::socket* socket, const rtps::Locator_t& to, bool multicast_only, bool for_all, const microseconds& timeout) __asm__(
    "_ZN8eprosima7fastdds4rtps21UDPTransportInterface4sendEPKhjRN4asio21basic_datagram_socketINS5_"
    "2ip3udpENS5_15any_io_executorEEERKNS_8fastrtps4rtps9Locator_tEbbRKNSt6chrono8durationIlSt5"
    "ratioILl1ELl1000000EEEE");

extern "C" bool topogeo_send_packet(void* transport, const std::uint8_t* packet, std::uint32_t size,
                                    asio::ip::udp::socket* socket, const rtps::Locator_t& to,
                                    bool multicast_only, bool for_all,
                                    const microseconds& timeout) {
  using Function = bool (*)(void*, const std::uint8_t*, std::uint32_t, asio::ip::udp::socket*,
                            const rtps::Locator_t&, bool, bool, const microseconds&);
  static const auto original = messaging::library_function<Function>(kSendPacket);
  if (multicast_only || to.kind != LOCATOR_KIND_UDPv4 || rtps::IPLocator::isMulticast(to) ||
      of_one_interface(*socket)) {
    return original(transport, packet, size, socket, to, multicast_only, for_all, timeout);
  }
  std::array<std::uint8_t, 4> address{};
  std::copy_n(rtps::IPLocator::getIPv4(to), address.size(), address.begin());
  const microseconds patience = std::clamp(timeout, microseconds::zero(), kLongestWait);
  return host_sockets().send({packet, size}, address, rtps::IPLocator::getPhysicalPort(to),
                             patience) != messaging::Sending::kFailed;
}

namespace topogeo::messaging {

void send_to_each_host_apart() {}

}  // namespace topogeo::messaging
