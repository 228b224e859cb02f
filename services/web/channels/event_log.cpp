#include "channels/event_log.hpp"

#include "topogeo/support/host.hpp"

#include "server/json_values.hpp"

namespace topogeo::web {
namespace {

const char* word_of(EventLog::Level level) {
  switch (level) {
    case EventLog::Level::kInfo:
      return "info";
    case EventLog::Level::kWarning:
      return "warning";
    case EventLog::Level::kError:
      break;
  }
  return "error";
}

}  // namespace

void EventLog::add(Level level, const std::string& source, const std::string& sentence) {
  const std::scoped_lock lock(mutex_);
  ++last_;
  std::vector<Edit> edits = {
      {std::to_string(last_), text_of(Json{{"time_s", seconds(support::wall_clock_ns())},
                                           {"level", word_of(level)},
                                           {"source", source},
                                           {"text", sentence}})}};
  if (last_ > kKept) edits.push_back({std::to_string(last_ - kKept), {}});
  hub_.edit(Channel::kEvents, std::move(edits));
}

void EventLog::alarm(Level level, const std::string& source, const std::string& sentence) {
  alarms_.raise(support::wall_clock_ns(), word_of(level), source, sentence);
  add(level, source, sentence);
}

void EventLog::acknowledge(std::span<const std::uint64_t> alarms, const std::string& who) {
  for (const std::string& text : alarms_.acknowledge(support::wall_clock_ns(), alarms, who)) {
    std::string event = who;
    event.append(": acknowledges the alarm ").append(text);
    add(Level::kInfo, "operator", event);
  }
}

}  // namespace topogeo::web
