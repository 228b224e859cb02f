// Ends a program cleanly on Ctrl-C and on SIGTERM.
#pragma once

#include <functional>
#include <thread>

namespace topogeo::messaging {

/// While it lives, SIGINT and SIGTERM call `on_signal` instead of ending the process, in a thread
/// of its own, so `on_signal` may do what a signal handler must not (EventLoop::stop). At most one
/// at a time; the previous handlers come back at the end. Signals are not blocked, so programs that
/// are started meanwhile have normal handling.
class SignalStop {
 public:
  /// Throws std::logic_error when there is one already, std::runtime_error when the system has no
  /// pipe or thread left.
  explicit SignalStop(std::function<void(int signal_number)> on_signal);
  SignalStop(const SignalStop&) = delete;
  SignalStop& operator=(const SignalStop&) = delete;
  ~SignalStop();

  /// Number of the first signal that came, 0 if none has.
  [[nodiscard]] static int received();

 private:
  std::thread thread_;
};

}  // namespace topogeo::messaging
