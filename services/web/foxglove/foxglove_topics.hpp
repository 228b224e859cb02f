// Topics for Foxglove and Lichtblick, with the schemas of their messages: Foxglove's well-known
// types in JSON, each described by a JSON schema.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "server/channel_hub.hpp"

namespace topogeo::web {

/// Topics that the service itself fills; only the newest message counts.
enum class LiveTopic : std::uint8_t { kTransforms, kPose, kScan, kMap, kRoomMap };
inline constexpr std::size_t kLiveTopics = static_cast<std::size_t>(LiveTopic::kRoomMap) + 1;

struct FoxgloveTopic {
  std::uint32_t channel_id = 0;
  std::string_view name;
  std::string_view schema;         ///< "foxglove.Grid"
  std::optional<LiveTopic> live;   ///< source: the service itself ...
  std::optional<Channel> channel;  ///< ... or a channel of the hub
  double shortest_period_s = 0.0;  ///< between two messages to one client
};

inline constexpr std::size_t kFoxgloveTopics = 11;
const std::array<FoxgloveTopic, kFoxgloveTopics>& foxglove_topics();
/// Null for an unknown channel.
const FoxgloveTopic* foxglove_topic(std::uint64_t channel_id);

/// JSON schema of a type, as text. Throws std::out_of_range for a type without a topic.
std::string foxglove_schema(std::string_view type);

/// The message that advertises all topics.
std::string advertisement();

}  // namespace topogeo::web
