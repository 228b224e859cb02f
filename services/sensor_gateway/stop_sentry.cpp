#include "stop_sentry.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <span>
#include <string_view>
#include <system_error>

#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

namespace topogeo::sensor_gateway {
namespace {

/// Not that of a service: a second gateway would be a fault.
constexpr std::string_view kSentryName = "stop_sentry";
constexpr int kSigns = 0;
constexpr int kPort = 1;

/// Gives the process its own name in the list of processes.
void rename_process() {
  const std::size_t size = std::strlen(program_invocation_name);
  std::memset(program_invocation_name, 0, size);
  std::memcpy(program_invocation_name, kSentryName.data(), std::min(size, kSentryName.size()));
}

void write_all(std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(kPort, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return;  // the port is gone, or takes nothing
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

/// The process. Only calls that a signal handler may make: other threads held locks at the fork.
[[noreturn]] void stand_sentry(int signs, int port, std::span<const std::uint8_t> stop_bytes,
                               int after_ms) {
  // Ctrl-C reaches the whole group, and the gateway still drives then.
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) ::signal(number, SIG_IGN);
  rename_process();
  // Sockets of the gateway must not outlive it. `signs` and `port` are never 0 or 1 in a service;
  // where they are, they stay as they are.
  const int safe_signs = ::dup(signs);
  const int safe_port = ::dup(port);
  if (safe_signs < 0 || safe_port < 0 || ::dup2(safe_signs, kSigns) < 0 ||
      ::dup2(safe_port, kPort) < 0) {
    ::_exit(1);
  }
  ::close_range(kPort + 1, ~0U, 0);
  bool armed = false;
  while (true) {
    pollfd sign{kSigns, POLLIN, 0};
    const int ready = ::poll(&sign, 1, armed ? after_ms : -1);
    if (ready == 0) {
      write_all(stop_bytes);
      armed = false;
      continue;
    }
    if (ready < 0 && errno == EINTR) continue;
    std::array<char, 64> received{};
    const ssize_t count = ready < 0 ? 0 : ::read(kSigns, received.data(), received.size());
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (count <= 0) break;  // the gateway has ended
    armed = true;
  }
  write_all(stop_bytes);
  ::_exit(0);
}

[[noreturn]] void fail(const char* what) {
  throw std::system_error(errno, std::system_category(), what);
}

}  // namespace

StopSentry::StopSentry(int port, const std::vector<std::uint8_t>& stop_bytes,
                       std::chrono::milliseconds after) {
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, ends.data()) != 0) {
    fail("stop sentry: socketpair");
  }
  process_ = ::fork();
  if (process_ == 0) {
    ::close(ends[0]);
    stand_sentry(ends[1], port, stop_bytes, static_cast<int>(after.count()));
  }
  ::close(ends[1]);
  signs_ = ends[0];
  if (process_ < 0) {
    const int error = errno;
    ::close(signs_);
    errno = error;
    fail("stop sentry: fork");
  }
}

StopSentry::~StopSentry() {
  ::close(signs_);
  while (::waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

void StopSentry::alive() {
  // A full buffer has signs enough.
  static_cast<void>(::send(signs_, "", 1, MSG_NOSIGNAL));
}

}  // namespace topogeo::sensor_gateway
