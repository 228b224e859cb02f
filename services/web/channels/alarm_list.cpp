#include "channels/alarm_list.hpp"

#include <algorithm>
#include <utility>

#include "server/json_values.hpp"

namespace topogeo::web {

AlarmList::AlarmList(ChannelHub& hub, const std::filesystem::path& file,
                     std::function<void()> not_kept)
    : hub_(hub), not_kept_(std::move(not_kept)), file_(file, kKept), alarms_(file_.open()) {
  if (alarms_.empty()) return;
  last_ = alarms_.rbegin()->first;
  std::vector<Edit> edits;
  for (const auto& [number, alarm] : alarms_) edits.push_back(shown(number, alarm));
  hub_.edit(Channel::kAlarms, std::move(edits));
}

void AlarmList::keep(std::uint64_t number) {
  if (!file_.keep(number, alarms_)) not_kept_();
}

Edit AlarmList::shown(std::uint64_t number, const Alarm& alarm) {
  Json json = {{"level", alarm.level},
               {"source", alarm.source},
               {"text", alarm.text},
               {"first_s", seconds(alarm.first_ns)},
               {"time_s", seconds(alarm.last_ns)},
               {"count", alarm.count},
               {"acknowledged_by", alarm.acknowledged_by}};
  if (!alarm.acknowledged_by.empty()) json["acknowledged_s"] = seconds(alarm.acknowledged_ns);
  return {std::to_string(number), text_of(json)};
}

void AlarmList::raise(std::int64_t wall_ns, const std::string& level, const std::string& source,
                      const std::string& text) {
  const std::scoped_lock lock(mutex_);
  auto found = std::ranges::find_if(alarms_, [&](const auto& entry) {
    const Alarm& alarm = entry.second;
    return alarm.acknowledged_by.empty() && alarm.source == source && alarm.text == text;
  });
  if (found == alarms_.end()) {
    found = alarms_.emplace(++last_, Alarm{level, source, text, wall_ns}).first;
  }
  found->second.last_ns = wall_ns;
  ++found->second.count;
  keep(found->first);
  std::vector<Edit> edits = {shown(found->first, found->second)};
  forget_one(edits);
  hub_.edit(Channel::kAlarms, std::move(edits));
}

void AlarmList::forget_one(std::vector<Edit>& edits) {
  if (alarms_.size() <= kKept) return;
  const auto acknowledged = std::ranges::find_if(
      alarms_, [](const auto& entry) { return !entry.second.acknowledged_by.empty(); });
  const auto oldest = acknowledged != alarms_.end() ? acknowledged : alarms_.begin();
  const std::uint64_t number = oldest->first;
  edits.push_back({std::to_string(number), {}});
  alarms_.erase(oldest);
  keep(number);
}

std::vector<std::string> AlarmList::acknowledge(std::int64_t wall_ns,
                                                std::span<const std::uint64_t> numbers,
                                                const std::string& who) {
  const std::scoped_lock lock(mutex_);
  std::vector<std::string> texts;
  std::vector<Edit> edits;
  for (const std::uint64_t number : numbers) {
    const auto found = alarms_.find(number);
    if (found == alarms_.end() || !found->second.acknowledged_by.empty()) continue;
    found->second.acknowledged_by = who;
    found->second.acknowledged_ns = wall_ns;
    keep(number);
    texts.push_back(found->second.source + ": " + found->second.text);
    edits.push_back(shown(number, found->second));
  }
  if (!edits.empty()) hub_.edit(Channel::kAlarms, std::move(edits));
  return texts;
}

}  // namespace topogeo::web
