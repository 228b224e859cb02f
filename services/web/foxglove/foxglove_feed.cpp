#include "foxglove/foxglove_feed.hpp"

#include <utility>

#include "topogeo/support/host.hpp"

namespace topogeo::web {

void FoxgloveFeed::on_change(std::function<void()> handler) {
  const std::scoped_lock lock(mutex_);
  on_change_ = std::move(handler);
}

void FoxgloveFeed::set(LiveTopic topic, std::function<std::string()> make) {
  auto entry = std::make_shared<Entry>();
  entry->time_ns = support::wall_clock_ns();
  entry->make = std::move(make);
  std::function<void()> handler;
  {
    const std::scoped_lock lock(mutex_);
    std::shared_ptr<Entry>& held = entries_.at(static_cast<std::size_t>(topic));
    entry->version = held ? held->version + 1 : 1;
    held = std::move(entry);
    handler = on_change_;
  }
  if (handler) handler();
}

std::uint64_t FoxgloveFeed::version(LiveTopic topic) const {
  const std::scoped_lock lock(mutex_);
  const auto& entry = entries_.at(static_cast<std::size_t>(topic));
  return entry ? entry->version : 0;
}

LiveMessage FoxgloveFeed::newest(LiveTopic topic) const {
  std::shared_ptr<Entry> entry;
  {
    const std::scoped_lock lock(mutex_);
    entry = entries_.at(static_cast<std::size_t>(topic));
  }
  if (!entry) return {};
  if (!entry->json) {
    entry->json = std::make_shared<const std::string>(entry->make());
    entry->make = {};  // and the data that it holds
  }
  return {entry->version, entry->time_ns, entry->json};
}

}  // namespace topogeo::web
