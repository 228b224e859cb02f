#include "topogeo/messaging/event_loop.hpp"

#include <algorithm>
#include <atomic>
#include <map>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fastdds/dds/core/condition/GuardCondition.hpp>
#include <fastdds/dds/core/condition/WaitSet.hpp>

#include "reader_impl.hpp"

namespace topogeo::messaging {

namespace dds = eprosima::fastdds::dds;
using Clock = std::chrono::steady_clock;

namespace {

/// Samples of one reader in a row, so that a full reader does not starve the others.
constexpr std::size_t kBatch = 32;
/// Longest wait; bounds the cost of a missed wake-up.
constexpr std::chrono::nanoseconds kMaxWait = std::chrono::seconds(1);

struct Timer {
  std::chrono::nanoseconds period{};  // zero: once
  std::function<void()> handler;
};

}  // namespace

struct EventLoop::Impl {
  struct Source {
    std::shared_ptr<detail::ReaderCore> reader;
    detail::ReaderCore::Handler handler;
  };

  bool run_until(std::optional<Clock::time_point> end);
  /// One round through timers, posted handlers, samples and events; true if samples were left.
  bool dispatch();
  bool dispatch_samples();
  void dispatch_events();
  void dispatch_timers();
  void wait(bool samples_left, std::optional<Clock::time_point> end);
  void wake() { guard.set_trigger_value(true); }

  dds::WaitSet waitset;
  dds::GuardCondition guard;
  std::vector<std::shared_ptr<Source>> sources;
  std::vector<std::shared_ptr<detail::WriterCore>> writers;
  std::vector<EventHandler> event_handlers;
  std::map<std::pair<Clock::time_point, std::uint64_t>, Timer> timers;  // by due time
  std::uint64_t timers_made = 0;
  std::chrono::nanoseconds timer_delay{};  // largest since it was taken
  std::mutex mutex;
  std::vector<std::function<void()>> posted;
  std::atomic<bool> stop_requested = false;
};

bool EventLoop::Impl::run_until(std::optional<Clock::time_point> end) {
  while (true) {
    const bool samples_left = dispatch();
    if (stop_requested.exchange(false)) return true;
    if (end && Clock::now() >= *end) return false;
    wait(samples_left, end);
  }
}

bool EventLoop::Impl::dispatch() {
  std::vector<std::function<void()>> handlers;
  {
    const std::lock_guard lock(mutex);
    handlers.swap(posted);
  }
  for (const auto& handler : handlers) handler();
  if (!stop_requested) dispatch_timers();
  if (stop_requested) return false;
  // Samples first: those of a departed writer count before its departure is reported.
  const bool samples_left = dispatch_samples();
  if (!stop_requested) dispatch_events();
  return samples_left;
}

bool EventLoop::Impl::dispatch_samples() {
  bool left = false;
  // The index stays valid when a handler adds readers.
  for (std::size_t i = 0; i < sources.size(); ++i) {  // NOLINT(modernize-loop-convert)
    const std::shared_ptr<Source> source = sources[i];
    std::size_t taken = 0;
    while (taken < kBatch && !stop_requested && source->reader->take(1, source->handler) == 1) {
      ++taken;
    }
    left = left || taken == kBatch;
    if (stop_requested) return true;
  }
  return left;
}

void EventLoop::Impl::dispatch_events() {
  const EventHandler call_handlers = [this](const Event& event) {
    for (std::size_t i = 0; i < event_handlers.size(); ++i) {  // NOLINT(modernize-loop-convert)
      const EventHandler handler = event_handlers[i];
      handler(event);
    }
  };
  for (std::size_t i = 0; i < sources.size(); ++i) {  // NOLINT(modernize-loop-convert)
    const std::shared_ptr<Source> source = sources[i];
    source->reader->take_events(call_handlers);
  }
  for (std::size_t i = 0; i < writers.size(); ++i) {  // NOLINT(modernize-loop-convert)
    const std::shared_ptr<detail::WriterCore> writer = writers[i];
    writer->take_events(call_handlers);
  }
}

void EventLoop::Impl::dispatch_timers() {
  const Clock::time_point now = Clock::now();
  // Reads the clock once, so that timers alone never keep the samples waiting.
  while (!timers.empty() && timers.begin()->first.first <= now && !stop_requested) {
    timer_delay =
        std::max<std::chrono::nanoseconds>(timer_delay, now - timers.begin()->first.first);
    auto node = timers.extract(timers.begin());
    const auto handler = node.mapped().handler;
    if (node.mapped().period.count() > 0) {
      node.key().first =
          std::max(node.key().first + node.mapped().period, now + std::chrono::nanoseconds(1));
      timers.insert(std::move(node));  // before the call: the handler may cancel it
    }
    handler();
  }
}

void EventLoop::Impl::wait(bool samples_left, std::optional<Clock::time_point> end) {
  const Clock::time_point now = Clock::now();
  std::chrono::nanoseconds timeout = kMaxWait;
  if (!timers.empty()) {
    timeout = std::min<std::chrono::nanoseconds>(timeout, timers.begin()->first.first - now);
  }
  if (end) timeout = std::min<std::chrono::nanoseconds>(timeout, *end - now);
  const bool orphans = std::any_of(sources.begin(), sources.end(), [](const auto& source) {
    return detail::LoopAccess::has_orphans(*source->reader);
  });
  if (samples_left || orphans) timeout = std::chrono::nanoseconds::zero();
  if (timeout.count() <= 0) return;
  dds::ConditionSeq active;
  waitset.wait(
      active,
      {0, static_cast<std::uint32_t>(std::min<std::int64_t>(timeout.count(), 999'999'999))});
  guard.set_trigger_value(false);  // the next round handles whatever set it
}

EventLoop::EventLoop() : impl_(std::make_unique<Impl>()) {
  impl_->waitset.attach_condition(impl_->guard);
}

EventLoop::~EventLoop() {
  for (const auto& source : impl_->sources) {
    source->reader->set_wake({});
    impl_->waitset.detach_condition(
        detail::LoopAccess::reader(*source->reader).get_statuscondition());
  }
  for (const auto& writer : impl_->writers) writer->set_wake({});
  impl_->waitset.detach_condition(impl_->guard);
}

void EventLoop::add_reader(std::shared_ptr<detail::ReaderCore> reader,
                           detail::ReaderCore::Handler handler) {
  reader->set_wake([impl = impl_.get()] { impl->wake(); });
  impl_->waitset.attach_condition(detail::LoopAccess::reader(*reader).get_statuscondition());
  impl_->sources.push_back(
      std::make_shared<Impl::Source>(Impl::Source{std::move(reader), std::move(handler)}));
  impl_->wake();  // events may already be waiting
}

void EventLoop::add_writer(std::shared_ptr<detail::WriterCore> writer) {
  writer->set_wake([impl = impl_.get()] { impl->wake(); });
  impl_->writers.push_back(std::move(writer));
  impl_->wake();
}

void EventLoop::on_event(EventHandler handler) {
  impl_->event_handlers.push_back(std::move(handler));
}

std::uint64_t EventLoop::add_timer(std::chrono::nanoseconds period, std::function<void()> handler) {
  if (period.count() <= 0) {
    throw std::invalid_argument("timer period: " + std::to_string(period.count()) +
                                " ns, expected more than 0");
  }
  const std::uint64_t timer = ++impl_->timers_made;
  impl_->timers.emplace(std::pair{Clock::now() + period, timer}, Timer{period, std::move(handler)});
  return timer;
}

std::uint64_t EventLoop::call_after(std::chrono::nanoseconds delay, std::function<void()> handler) {
  const std::uint64_t timer = ++impl_->timers_made;
  impl_->timers.emplace(std::pair{Clock::now() + delay, timer}, Timer{{}, std::move(handler)});
  return timer;
}

void EventLoop::cancel_timer(std::uint64_t timer) {
  std::erase_if(impl_->timers, [&](const auto& entry) { return entry.first.second == timer; });
}

std::chrono::nanoseconds EventLoop::take_timer_delay() {
  return std::exchange(impl_->timer_delay, {});
}

void EventLoop::post(std::function<void()> handler) {
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->posted.push_back(std::move(handler));
  }
  impl_->wake();
}

std::vector<Traffic> EventLoop::traffic() const {
  std::vector<Traffic> all;
  for (const auto& source : impl_->sources) {
    all.push_back(
        {source->reader->topic(), false, source->reader->messages(), source->reader->waiting()});
  }
  for (const auto& writer : impl_->writers) {
    all.push_back({writer->topic(), true, writer->messages(), 0});
  }
  return all;
}

void EventLoop::run() {
  impl_->run_until({});
}

bool EventLoop::run_for(std::chrono::nanoseconds duration) {
  return impl_->run_until(Clock::now() + duration);
}

void EventLoop::stop() {
  impl_->stop_requested = true;
  impl_->wake();
}

}  // namespace topogeo::messaging
