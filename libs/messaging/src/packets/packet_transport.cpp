// Fast DDS sends everything through one socket that blocks, with a lock held that each writer of
// the process needs: two hosts that were switched off, or a stranger who announces himself at
// addresses that nobody has, stop all its messages for three seconds again and again, those within
// its host, too. Therefore a socket for each host (host_sockets.hpp).
#include "packet_transport.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <vector>

#include "topogeo/messaging/detail/fast_dds.hpp"

#include "../network_names.hpp"
#include "host_sockets.hpp"

#if TOPOGEO_FAST_DDS == 2
#include <fastdds/rtps/common/LocatorList.hpp>
#include <fastdds/rtps/network/SenderResource.h>
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/UDPv6TransportDescriptor.h>
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.h>
#else
#include <fastdds/rtps/common/LocatorList.hpp>
#include <fastdds/rtps/transport/ChainingTransport.hpp>
#include <fastdds/rtps/transport/SenderResource.hpp>
#include <fastdds/rtps/transport/UDPv6TransportDescriptor.hpp>
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.hpp>
#endif

namespace topogeo::messaging {

namespace {

namespace transports = eprosima::fastdds::rtps;
using std::chrono::steady_clock;
using LocatorsIterator = transports::LocatorsIterator;

/// Longest wait for a host that takes packets slowly: as long as a writer may block.
constexpr std::chrono::milliseconds kLongestWait{100};

HostSockets& host_sockets() {
  static HostSockets all;
  return all;
}

/// The parts of a packet that leaves, as each version has them.
#if TOPOGEO_FAST_DDS == 2
struct Outgoing {
  const rtps::octet* bytes;
  std::uint32_t size;

  bool send_by(rtps::SenderResource& sender, LocatorsIterator* begin, LocatorsIterator* end,
               const steady_clock::time_point& latest) const {
    return sender.send(bytes, size, begin, end, latest);
  }
  [[nodiscard]] std::vector<iovec> parts() const {
    return {{const_cast<rtps::octet*>(bytes), size}};  // NOLINT(*-const-cast): it is only read
  }
};
#else
struct Outgoing {
  const std::vector<transports::NetworkBuffer>& buffers;
  std::uint32_t size;

  bool send_by(rtps::SenderResource& sender, LocatorsIterator* begin, LocatorsIterator* end,
               const steady_clock::time_point& latest) const {
    return sender.send(buffers, size, begin, end, latest);
  }
  [[nodiscard]] std::vector<iovec> parts() const {
    std::vector<iovec> all;
    for (const transports::NetworkBuffer& buffer : buffers) {
      // NOLINTNEXTLINE(*-const-cast): it is only read
      all.push_back({const_cast<void*>(buffer.buffer), buffer.size});
    }
    return all;
  }
};
#endif

bool to_one_host(const rtps::Locator_t& to) {
  return to.kind == LOCATOR_KIND_UDPv4 && !IPLocator::isMulticast(to);
}

bool send_to_host(std::span<const iovec> parts, const rtps::Locator_t& to,
                  const steady_clock::time_point& latest) {
  std::array<std::uint8_t, 4> address{};
  std::copy_n(IPLocator::getIPv4(to), address.size(), address.begin());
  const auto patience = std::clamp<steady_clock::duration>(
      latest - steady_clock::now(), steady_clock::duration::zero(), kLongestWait);
  return host_sockets().send(parts, address, IPLocator::getPhysicalPort(to), patience) !=
         Sending::kFailed;
}

/// How the transport that is inside is made.
struct Inside : transports::ChainingTransportDescriptor {
  using ChainingTransportDescriptor::ChainingTransportDescriptor;
  [[nodiscard]] transports::TransportInterface* create_transport() const override {
    return nullptr;
  }
};

class PacketTransport : public transports::ChainingTransport {
 public:
  PacketTransport(const Inside& inside, const PacketFilter& filter, bool hosts_apart)
      : ChainingTransport(inside), filter_(filter), hosts_apart_(hosts_apart) {}

  transports::TransportDescriptorInterface* get_configuration() override {
    return low_level_transport_->get_configuration();
  }

  /// Shared memory has one sender for all. It does not know it again in a chain, and would add
  /// another one for each locator, which would send everything once more.
  bool OpenOutputChannel(transports::SendResourceList& senders,
                         const rtps::Locator_t& locator) override {
    if (kind() != LOCATOR_KIND_SHM || !output_open_) {
      output_open_ = ChainingTransport::OpenOutputChannel(senders, locator);
      return output_open_;
    }
    transports::SendResourceList another;
    return low_level_transport_->OpenOutputChannel(another, locator);
  }

  void receive(transports::TransportReceiverInterface* next, const rtps::octet* packet,
               std::uint32_t size, const rtps::Locator_t& local,
               const rtps::Locator_t& remote) override {
    const std::span<const std::uint8_t> admitted = filter_.admit({packet, size});
    if (admitted.empty()) return;
    next->OnDataReceived(admitted.data(), static_cast<std::uint32_t>(admitted.size()), local,
                         remote);
  }

#if TOPOGEO_FAST_DDS == 2
  bool send(rtps::SenderResource* sender, const rtps::octet* packet, std::uint32_t size,
            LocatorsIterator* begin, LocatorsIterator* end,
            const steady_clock::time_point& latest) override {
    return send(*sender, Outgoing{packet, size}, begin, end, latest);
  }
#else
  bool send(rtps::SenderResource* sender, const std::vector<transports::NetworkBuffer>& buffers,
            std::uint32_t size, LocatorsIterator* begin, LocatorsIterator* end,
            const steady_clock::time_point& latest) override {
    return send(*sender, Outgoing{buffers, size}, begin, end, latest);
  }
#endif

 private:
  bool send(rtps::SenderResource& sender, const Outgoing& packet, LocatorsIterator* begin,
            LocatorsIterator* end, const steady_clock::time_point& latest) {
    if (!hosts_apart_ || !carries_unicast(sender)) {
      return packet.send_by(sender, begin, end, latest);
    }
    const std::vector<iovec> parts = packet.parts();
    transports::LocatorList others;
    bool sent = true;
    for (LocatorsIterator& to = *begin; to != *end; ++to) {
      if (to_one_host(*to)) {
        sent = send_to_host(parts, *to, latest) && sent;
      } else {
        others.push_back(*to);
      }
    }
    if (others.empty()) return sent;
    transports::Locators others_begin(others.begin());
    transports::Locators others_end(others.end());
    return packet.send_by(sender, &others_begin, &others_end, latest) && sent;
  }

  /// The first sender of UDP without chosen interfaces sends to any host, and is asked first; the
  /// others send only by multicast through one interface each.
  bool carries_unicast(const rtps::SenderResource& sender) {
    const rtps::SenderResource* first = nullptr;
    return first_sender_.compare_exchange_strong(first, &sender) || first == &sender;
  }

  PacketFilter filter_;
  bool hosts_apart_;
  bool output_open_ = false;
  std::atomic<const rtps::SenderResource*> first_sender_ = nullptr;
};

/// A transport of this kind with ours around it. Still a descriptor of its kind, of which the
/// middleware asks what the participant has.
template <class Descriptor>
class Filtered : public Descriptor {
 public:
  Filtered(const Descriptor& plain, const PacketFilter& filter, bool hosts_apart)
      : Descriptor(plain), filter_(filter), hosts_apart_(hosts_apart) {}

  [[nodiscard]] transports::TransportInterface* create_transport() const override {
    const auto plain = std::make_shared<Descriptor>(static_cast<const Descriptor&>(*this));
    // NOLINTNEXTLINE(cppcoreguidelines-owning-memory): the interface
    return new PacketTransport(Inside(plain), filter_, hosts_apart_);
  }

 private:
  PacketFilter filter_;
  bool hosts_apart_;
};

using Transport = std::shared_ptr<transports::TransportDescriptorInterface>;

template <class Descriptor>
Transport filtered(const Transport& transport, const PacketFilter& filter, bool hosts_apart) {
  const auto* plain = dynamic_cast<const Descriptor*>(transport.get());
  if (plain == nullptr) return nullptr;
  return std::make_shared<Filtered<Descriptor>>(*plain, filter, hosts_apart);
}

/// A profile may name the interfaces that are used; their sockets are bound to them.
bool any_interface(const Transport& transport) {
  const auto* udp = dynamic_cast<const UDPv4TransportDescriptor*>(transport.get());
  if (udp == nullptr) return false;
#if TOPOGEO_FAST_DDS == 2
  return udp->interfaceWhiteList.empty();
#else
  return udp->interfaceWhiteList.empty() && udp->interface_allowlist.empty() &&
         udp->interface_blocklist.empty();
#endif
}

/// Names the transports that the middleware uses where a profile names none.
void name_builtin_transports(eprosima::fastdds::dds::DomainParticipantQos& qos) {
  if (!qos.transport().use_builtin_transports) return;
  auto udp = std::make_shared<UDPv4TransportDescriptor>();
  udp->sendBufferSize = qos.transport().send_socket_buffer_size;
  udp->receiveBufferSize = qos.transport().listen_socket_buffer_size;
  qos.transport().user_transports.push_back(udp);
  auto memory = std::make_shared<transports::SharedMemTransportDescriptor>();
  memory->max_message_size(udp->max_message_size());
  qos.transport().user_transports.push_back(memory);
  qos.transport().use_builtin_transports = false;
}

}  // namespace

void filter_packets(eprosima::fastdds::dds::DomainParticipantQos& qos, const std::string& profile,
                    const PacketFilter::Options& options) {
  name_builtin_transports(qos);
  const PacketFilter filter(options);
  for (Transport& transport : qos.transport().user_transports) {
    const bool hosts_apart = any_interface(transport);
    Transport ours = filtered<UDPv4TransportDescriptor>(transport, filter, hosts_apart);
    if (!ours) ours = filtered<transports::UDPv6TransportDescriptor>(transport, filter, false);
    if (!ours) ours = filtered<transports::SharedMemTransportDescriptor>(transport, filter, false);
    if (!ours) {
      throw std::runtime_error("DDS participant profile '" + profile +
                               "': a transport is neither UDP nor shared memory");
    }
    transport = ours;
  }
}

}  // namespace topogeo::messaging
