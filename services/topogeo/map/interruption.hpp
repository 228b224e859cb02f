// Ends work in this process at Ctrl-C or SIGTERM.
#pragma once

#include <atomic>
#include <cstdlib>
#include <mutex>
#include <string_view>

#include <unistd.h>

#include "topogeo/messaging/signal_stop.hpp"

#include "commands.hpp"

namespace topogeo::cli {

/// Ctrl-C requests that the work end after the current scan. Work that does not check for this ends
/// at once, which loses nothing because nothing has been written.
class Interruption {
 public:
  Interruption() : signals_([this](int number) { on_signal(number); }) {}

  /// While it exists, a signal ends the program at once.
  class Immediate {
   public:
    explicit Immediate(Interruption& owner) : owner_(owner) { owner_.set_immediate(true); }
    Immediate(const Immediate&) = delete;
    Immediate& operator=(const Immediate&) = delete;
    ~Immediate() { owner_.set_immediate(false); }

   private:
    Interruption& owner_;
  };

  /// Number of the received signal, 0 if there is none.
  [[nodiscard]] int received() const { return received_; }

 private:
  void set_immediate(bool immediate) {
    const std::lock_guard lock(mutex_);
    immediate_ = immediate;
  }
  void on_signal(int number) {
    const std::lock_guard lock(mutex_);
    received_ = number;
    if (!immediate_) return;
    constexpr std::string_view kText = "\ntopogeo: stopped, nothing was written\n";
    [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, kText.data(), kText.size());
    std::_Exit(kSignalBase + number);
  }

  std::mutex mutex_;
  bool immediate_ = false;
  std::atomic<int> received_ = 0;
  messaging::SignalStop signals_;  // last: its thread uses the others
};

}  // namespace topogeo::cli
