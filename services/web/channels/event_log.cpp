#include "channels/event_log.hpp"

#include "topogeo/support/host.hpp"

#include "server/json_values.hpp"

namespace topogeo::web {

void EventLog::add(Level level, const std::string& source, const std::string& sentence) {
  const char* const word =
      level == Level::kInfo ? "info" : (level == Level::kWarning ? "warning" : "error");
  const std::scoped_lock lock(mutex_);
  ++last_;
  std::vector<Edit> edits = {
      {std::to_string(last_), text_of(Json{{"time_s", seconds(support::wall_clock_ns())},
                                           {"level", word},
                                           {"source", source},
                                           {"text", sentence}})}};
  if (last_ > kKept) edits.push_back({std::to_string(last_ - kKept), {}});
  hub_.edit(Channel::kEvents, std::move(edits));
}

}  // namespace topogeo::web
