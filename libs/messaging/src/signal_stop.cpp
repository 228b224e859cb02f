#include "topogeo/messaging/signal_stop.hpp"

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <stdexcept>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

namespace topogeo::messaging {

namespace {

constexpr unsigned char kEnd = 0;  // written to the pipe instead of a signal number

std::atomic<int> write_end = -1;
std::atomic<int> first_signal = 0;
std::atomic<bool> exists = false;
std::array<struct sigaction, 2> previous;
constexpr std::array kSignals = {SIGINT, SIGTERM};

extern "C" void topogeo_forward_signal(int number) {
  const int saved = errno;
  int none = 0;
  first_signal.compare_exchange_strong(none, number);
  const auto byte = static_cast<unsigned char>(number);
  [[maybe_unused]] const ssize_t written = ::write(write_end.load(), &byte, 1);
  errno = saved;
}

void forward(int read_end, const std::function<void(int)>& on_signal) {
  unsigned char byte = kEnd;
  while (true) {
    const ssize_t count = ::read(read_end, &byte, 1);
    if (count < 0 && errno == EINTR) continue;
    if (count != 1 || byte == kEnd) break;
    on_signal(byte);
  }
  ::close(read_end);
}

}  // namespace

SignalStop::SignalStop(std::function<void(int)> on_signal) {
  if (exists.exchange(true)) throw std::logic_error("SignalStop: another one exists");
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) {
    exists = false;
    throw std::runtime_error("SignalStop: cannot make a pipe");
  }
  write_end = ends[1];
  first_signal = 0;
  thread_ = std::thread(
      [read_end = ends[0], handler = std::move(on_signal)] { forward(read_end, handler); });
  struct sigaction action = {};
  action.sa_handler = topogeo_forward_signal;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &action, &previous[i]);
}

SignalStop::~SignalStop() {
  for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &previous[i], nullptr);
  [[maybe_unused]] const ssize_t written = ::write(write_end.load(), &kEnd, 1);
  thread_.join();
  ::close(write_end.exchange(-1));
  exists = false;
}

int SignalStop::received() {
  return first_signal;
}

}  // namespace topogeo::messaging
