// The other topics that a program reads, as announced with each of its readers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/messaging/events.hpp"

#include "peer_listener.hpp"

namespace topogeo::messaging {

/// User data of a reader (Object Management Group, DDS 1.4, chapter 2.2.3.1):
/// "read_with=TOPIC,TOPIC;". Other keys may stand beside it.
std::vector<std::uint8_t> announce_read_with(std::span<const std::string_view> topics);
/// The topics of such user data; none for other user data or for more than 1 kB.
std::vector<std::string> parse_read_with(std::span<const std::uint8_t> user_data);

/// Remembers the announcements of the readers of other participants. Discovery reports a reader to
/// it before the reader is connected.
class ReadWithListener : public PeerListener {
 public:
  void on_peer(const DiscoveredPeer& peer) override;
  void on_peer_endpoint(const DiscoveredEndpoint& endpoint) override;

  /// Whole names; none when the reader has announced none.
  std::vector<std::string> read_with(const Handle& reader) const;

 private:
  /// Bounds the memory in a flood of strangers; a run has a dozen such readers.
  static constexpr std::size_t kMostReaders = 4096;

  mutable std::mutex read_with_mutex_;
  std::map<Handle, std::vector<std::string>> read_with_;  // by reader
};

}  // namespace topogeo::messaging
