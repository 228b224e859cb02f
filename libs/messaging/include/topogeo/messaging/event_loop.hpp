// One thread that waits for samples, events and timers and calls handlers, one after the other.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string_view>
#include <vector>

#include "topogeo/messaging/events.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/writer.hpp"

namespace topogeo::messaging {

/// Messages of one topic that came in or went out through a loop.
struct Traffic {
  std::string_view topic;  ///< whole name
  bool sent = false;
  std::uint64_t messages = 0;
  std::uint64_t waiting = 0;  ///< received and not handled yet
};

/// All handlers run in the thread that calls run(). An exception of a handler leaves run(), except
/// std::invalid_argument of a message handler, which refuses the message (kInvalidSample). Added
/// readers and writers live at least as long as the loop. Add them before run() or from a handler.
class EventLoop {
 public:
  using InstanceHandler = std::function<void(const SampleInfo&)>;

  EventLoop();
  EventLoop(const EventLoop&) = delete;
  EventLoop& operator=(const EventLoop&) = delete;
  ~EventLoop();

  /// `on_message` gets the messages, `on_gone` the instances that were disposed or have lost their
  /// writer.
  template <class T>
  void add(const Reader<T>& reader, std::function<void(const T&, const SampleInfo&)> on_message,
           InstanceHandler on_gone = {}) {
    add_reader(reader.core(), [on_message = std::move(on_message), on_gone = std::move(on_gone)](
                                  const void* message, const SampleInfo& info) {
      if (info.valid) {
        on_message(*static_cast<const T*>(message), info);
      } else if (on_gone) {
        on_gone(info);
      }
    });
  }

  /// Passes the events of a writer to the event handlers.
  template <class T>
  void add(const Writer<T>& writer) {
    add_writer(writer.core());
  }

  /// Gets the events of every reader and writer of the loop. Several handlers are called in the
  /// order in which they were set.
  void on_event(EventHandler handler);

  /// Calls `handler` every `period` (> 0), by the steady clock, first after one period. Ticks
  /// missed in between are dropped. Returns a number for cancel_timer.
  std::uint64_t add_timer(std::chrono::nanoseconds period, std::function<void()> handler);
  /// Calls `handler` once after `delay` (>= 0).
  std::uint64_t call_after(std::chrono::nanoseconds delay, std::function<void()> handler);
  void cancel_timer(std::uint64_t timer);
  /// The largest delay between the due time of a timer and its call since the last call of this
  /// function, because a handler took long or the machine had no time for this thread.
  [[nodiscard]] std::chrono::nanoseconds take_timer_delay();

  /// Calls `handler` in the loop's thread. For other threads; not for signal handlers.
  void post(std::function<void()> handler);

  /// The traffic of all readers and writers of the loop, in the order in which they were added. A
  /// topic with two of them is listed twice.
  [[nodiscard]] std::vector<Traffic> traffic() const;

  /// Works until stop() is called, and first handles everything that is already waiting.
  void run();
  /// Works until stop() is called (then true) or `duration` has passed (then false).
  bool run_for(std::chrono::nanoseconds duration);
  /// Makes run() return after the handler that runs now; if none runs, the next run() returns at
  /// once. For any thread; not for signal handlers (SignalStop is for these).
  void stop();

 private:
  void add_reader(std::shared_ptr<detail::ReaderCore> reader, detail::ReaderCore::Handler handler);
  void add_writer(std::shared_ptr<detail::WriterCore> writer);

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace topogeo::messaging
