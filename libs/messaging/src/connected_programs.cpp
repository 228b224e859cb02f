#include "topogeo/messaging/connected_programs.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "topogeo/messaging/same_participant.hpp"

namespace topogeo::messaging {

int ConnectedPrograms::count() const {
  std::map<ParticipantPrefix, bool> connected;  // with everything
  for (const Handle& reader : counted_->peers()) {
    bool& whole = connected.try_emplace(prefix_of(reader), true).first->second;
    whole = whole && missing_of(reader).empty();
  }
  return static_cast<int>(
      std::ranges::count_if(connected, [](const auto& program) { return program.second; }));
}

std::string ConnectedPrograms::missing() const {
  std::set<std::string> names;
  for (const Handle& reader : counted_->peers()) {
    for (const std::string& topic : missing_of(reader)) {
      names.insert(topic.substr(topic.rfind('/') + 1));
    }
  }
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

std::vector<std::string> ConnectedPrograms::missing_of(const Handle& reader) const {
  std::vector<std::string> topics = counted_->read_with(reader);
  std::erase_if(topics, [&](const std::string& topic) {
    const auto writer = std::ranges::find(others_, topic, &detail::WriterCore::topic);
    // Without a writer here, another program sends the topic.
    return writer == others_.end() || (*writer)->connected_with(reader);
  });
  return topics;
}

}  // namespace topogeo::messaging
