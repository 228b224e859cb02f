#include "host_sockets.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include <linux/sockios.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

namespace topogeo::messaging {

namespace {

using std::chrono::steady_clock;

/// A host that takes nothing for so long is not waited for: fifty full packets at 100 Mbit/s.
constexpr std::chrono::milliseconds kTakesNothing{5};

int waiting_bytes(int socket) {
  int bytes = 0;
  return ::ioctl(socket, SIOCOUTQ, &bytes) == 0 ? bytes : 0;
}

support::FileDescriptor open_socket(int queue_bytes) {
  support::FileDescriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  if (!socket.is_open()) return socket;
  socklen_t size = sizeof queue_bytes;
  if (queue_bytes == 0) {
    ::getsockopt(socket.get(), SOL_SOCKET, SO_SNDBUF, &queue_bytes, &size);
  }
  // The system doubles what it is given, for its own bookkeeping: as for a socket of Fast DDS.
  ::setsockopt(socket.get(), SOL_SOCKET, SO_SNDBUF, &queue_bytes, size);
  return socket;
}

}  // namespace

std::shared_ptr<HostSockets::Host> HostSockets::host(const std::array<std::uint8_t, 4>& address) {
  const std::lock_guard lock(mutex_);
  if (const auto found = hosts_.find(address); found != hosts_.end()) {
    found->second->used = ++uses_;
    return found->second;
  }
  if (hosts_.size() >= options_.most_hosts) {
    hosts_.erase(
        std::ranges::min_element(hosts_, {}, [](const auto& entry) { return entry.second->used; }));
  }
  auto made = std::make_shared<Host>();
  made->socket = open_socket(options_.queue_bytes);
  made->used = ++uses_;
  if (!made->socket.is_open()) return made;
  return hosts_.emplace(address, std::move(made)).first->second;
}

std::size_t HostSockets::hosts() const {
  const std::lock_guard lock(mutex_);
  return hosts_.size();
}

Sending HostSockets::send(std::span<const iovec> parts, const std::array<std::uint8_t, 4>& address,
                          std::uint16_t port, std::chrono::nanoseconds patience) {
  const std::shared_ptr<Host> to_host = host(address);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(port);
  std::memcpy(&to.sin_addr, address.data(), address.size());
  msghdr packet{};
  packet.msg_name = &to;
  packet.msg_namelen = sizeof to;
  packet.msg_iov = const_cast<iovec*>(parts.data());  // NOLINT(*-const-cast): it is only read
  packet.msg_iovlen = parts.size();
  const steady_clock::time_point end = steady_clock::now() + patience;
  while (true) {
    if (::sendmsg(to_host->socket.get(), &packet, MSG_DONTWAIT | MSG_NOSIGNAL) >= 0) {
      return Sending::kDone;
    }
    if (errno == EINTR) continue;
    if (errno != EAGAIN && errno != EWOULDBLOCK && errno != ENOBUFS) return Sending::kFailed;
    if (steady_clock::now() >= end || !wait_for_room(*to_host)) return Sending::kDropped;
  }
}

/// True as soon as the host has taken something; false when it does not.
bool HostSockets::wait_for_room(Host& host) {
  const int full_bytes = waiting_bytes(host.socket.get());
  const int stuck_bytes = host.stuck_bytes.load(std::memory_order_relaxed);
  if (stuck_bytes > 0 && full_bytes >= stuck_bytes) return false;  // nothing since then
  const steady_clock::time_point end = steady_clock::now() + kTakesNothing;
  do {
    pollfd room{host.socket.get(), POLLOUT, 0};  // as soon as half of the queue is free
    static_cast<void>(::poll(&room, 1, 1));
    if (waiting_bytes(host.socket.get()) < full_bytes) {
      host.stuck_bytes.store(0, std::memory_order_relaxed);
      return true;
    }
  } while (steady_clock::now() < end);
  host.stuck_bytes.store(full_bytes, std::memory_order_relaxed);
  return false;
}

}  // namespace topogeo::messaging
