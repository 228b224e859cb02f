// Sockets of which each sends to one host alone. The packets of a socket wait in one queue: for a
// host that nobody answers for, one that was switched off or that a stranger made up, the kernel
// keeps them for three seconds, as long as it asks for the host's address. With one socket for all,
// what goes to the others waits as long.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <span>

#include <sys/uio.h>

#include "topogeo/support/file_descriptor.hpp"

namespace topogeo::messaging {

enum class Sending : std::uint8_t {
  kDone,
  kDropped,  ///< its host takes nothing now: as good as lost on the way
  kFailed,   ///< errno says why
};

/// For any threads.
class HostSockets {
 public:
  struct Options {
    /// More hosts than a robot talks to; a socket for another one takes the place of the one that
    /// was used longest ago.
    std::size_t most_hosts = 128;
    /// Bytes that may wait for one host; 0: as many as the system gives.
    int queue_bytes = 0;
  };

  HostSockets() : HostSockets(Options{}) {}
  explicit HostSockets(const Options& options) : options_(options) {}

  /// Sends to a port of an IPv4 address, whose four bytes are in the order in which they are
  /// written. While the queue is full waits for a host that takes something, up to `patience`.
  /// `parts`: of the packet, one after the other.
  Sending send(std::span<const iovec> parts, const std::array<std::uint8_t, 4>& address,
               std::uint16_t port, std::chrono::nanoseconds patience);
  /// Hosts that have a socket.
  [[nodiscard]] std::size_t hosts() const;

 private:
  struct Host {
    support::FileDescriptor socket;
    std::atomic<int> stuck_bytes = 0;  // in the queue when the host last took nothing
    std::uint64_t used = 0;
  };

  std::shared_ptr<Host> host(const std::array<std::uint8_t, 4>& address);
  static bool wait_for_room(Host& host);

  Options options_;
  mutable std::mutex mutex_;
  std::map<std::array<std::uint8_t, 4>, std::shared_ptr<Host>> hosts_;
  std::uint64_t uses_ = 0;
};

}  // namespace topogeo::messaging
