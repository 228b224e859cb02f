#include "serial_line.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>
#include <vector>

#include "topogeo/support/host.hpp"

namespace topogeo::sensor_gateway {

namespace {

/// A timer that fires later than this means that the process did not get to run.
constexpr std::int64_t kLate_ns = 50'000'000;
/// Time for the port's thread to read bytes that came meanwhile.
constexpr std::chrono::milliseconds kReadTime{10};

}  // namespace

SerialLine::SerialLine(messaging::EventLoop& loop, devices::SerialDriver& driver,
                       const PortOptions& options, AfterHandler after)
    : loop_(loop),
      driver_(driver),
      after_(std::move(after)),
      self_(std::make_shared<SerialLine*>(this)) {
  // The loop outlives the port and its thread, but this line may go before events they have posted.
  port_ =
      std::make_unique<SerialPort>(options, [&event_loop = loop, self = self_](PortEvent event) {
        event_loop.post([self, event = std::move(event)] {
          if (*self != nullptr) (*self)->on_event(event);
        });
      });
}

SerialLine::~SerialLine() {
  *self_ = nullptr;
  if (timer_armed_) loop_.cancel_timer(timer_);
}

std::int64_t SerialLine::now_ns() {
  last_ns_ = std::max(last_ns_, support::monotonic_ns());
  return last_ns_;
}

void SerialLine::on_event(const PortEvent& event) {
  last_ns_ = std::max(last_ns_, event.stamp_ns);
  switch (event.kind) {
    case PortEvent::Kind::kOpened:
      open_ = true;
      why_closed_.clear();
      epoch_opened_ = event.epoch;
      given_ = 0;
      ++statistics_.opened;
      driver_.opened(last_ns_);
      break;
    case PortEvent::Kind::kNotOpened:
      why_closed_ = event.why;
      ++statistics_.not_opened;
      break;
    case PortEvent::Kind::kLost:
      open_ = false;
      why_closed_ = event.why;
      ++statistics_.lost;
      driver_.lost(last_ns_);
      break;
    case PortEvent::Kind::kBytes:
      statistics_.bytes_in += event.bytes.size();
      if (event.epoch != port_->epoch()) {
        statistics_.bytes_stale += event.bytes.size();
        return;
      }
      driver_.receive(event.bytes, last_ns_);
      break;
    case PortEvent::Kind::kWritten:
      if (event.orders == given_) driver_.written(last_ns_);
      break;
  }
  after(last_ns_);
}

void SerialLine::after(std::int64_t now_ns) {
  if (after_) after_(now_ns);
  carry_out();
}

void SerialLine::carry_out() {
  std::vector<devices::LineOrder> orders = driver_.take_orders();
  if (!orders.empty() && open_) {
    given_ += orders.size();
    port_->write(std::move(orders), epoch_opened_);
  }
  arm();
}

void SerialLine::tick() {
  timer_armed_ = false;
  const std::int64_t now = now_ns();
  if (now - timer_due_ns_ > kLate_ns && !deferred_) {
    // The device was not silent; this process did not listen.
    deferred_ = true;
    timer_armed_ = true;
    timer_ = loop_.call_after(kReadTime, [this] { tick(); });
    return;
  }
  if (now >= driver_.due_ns()) driver_.tick(now);
  after(now);
}

void SerialLine::arm() {
  const std::int64_t due_ns = driver_.due_ns();
  if (timer_armed_ && due_ns == timer_due_ns_) return;
  if (timer_armed_) loop_.cancel_timer(timer_);
  timer_armed_ = due_ns != std::numeric_limits<std::int64_t>::max();
  if (!timer_armed_) return;
  timer_due_ns_ = due_ns;
  deferred_ = false;
  const std::int64_t wait_ns = std::max<std::int64_t>(0, due_ns - now_ns());
  timer_ = loop_.call_after(std::chrono::nanoseconds(wait_ns), [this] { tick(); });
}

}  // namespace topogeo::sensor_gateway
