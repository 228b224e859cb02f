#include "read_with.hpp"

#include <algorithm>
#include <utility>

#include "topogeo/messaging/same_participant.hpp"

#include "endpoint_shared.hpp"

namespace topogeo::messaging {

namespace {

constexpr std::string_view kReadWithKey = "read_with=";
constexpr std::size_t kMostUserData_bytes = 1024;

/// The non-empty parts between separators.
std::vector<std::string> parts_of(std::string_view text, char separator) {
  std::vector<std::string> parts;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(separator), text.size());
    if (end > 0) parts.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return parts;
}

}  // namespace

std::vector<std::uint8_t> announce_read_with(std::span<const std::string_view> topics) {
  if (topics.empty()) return {};
  std::string text(kReadWithKey);
  for (const std::string_view topic : topics) text.append(topic).push_back(',');
  text.back() = ';';
  return {text.begin(), text.end()};
}

std::vector<std::string> parse_read_with(std::span<const std::uint8_t> user_data) {
  if (user_data.size() > kMostUserData_bytes) return {};
  const std::string text(user_data.begin(), user_data.end());
  for (const std::string& entry : parts_of(text, ';')) {
    if (entry.starts_with(kReadWithKey)) return parts_of(entry.substr(kReadWithKey.size()), ',');
  }
  return {};
}

void ReadWithListener::on_peer(const DiscoveredPeer& peer) {
  if (!peer.gone) return;
  const Handle gone = detail::to_handle(rtps::InstanceHandle_t(peer.id));
  const std::lock_guard lock(read_with_mutex_);
  std::erase_if(read_with_, [&](const auto& entry) { return same_participant(entry.first, gone); });
}

void ReadWithListener::on_peer_endpoint(const DiscoveredEndpoint& endpoint) {
  if (endpoint.endpoint.writer) return;
  const Handle reader = endpoint.endpoint.id;
  std::vector<std::string> topics =
      endpoint.gone ? std::vector<std::string>{} : parse_read_with(endpoint.user_data);
  const std::lock_guard lock(read_with_mutex_);
  if (topics.empty()) {
    read_with_.erase(reader);
  } else if (read_with_.size() < kMostReaders || read_with_.contains(reader)) {
    read_with_[reader] = std::move(topics);
  }
}

std::vector<std::string> ReadWithListener::read_with(const Handle& reader) const {
  const std::lock_guard lock(read_with_mutex_);
  const auto found = read_with_.find(reader);
  return found == read_with_.end() ? std::vector<std::string>{} : found->second;
}

}  // namespace topogeo::messaging
