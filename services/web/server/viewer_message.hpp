// Messages from a page through its WebSocket.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/channel_hub.hpp"

namespace topogeo::web {

struct ViewerMessage {
  enum class Op : std::uint8_t { kHello, kWant, kResync, kPing, kDrive, kRelease, kStop };

  Op op = Op::kPing;
  std::string token;                      ///< kHello
  std::string page;                       ///< kHello: secret id of the page, see Controls
  std::string name;                       ///< kHello: of the operator, for others
  std::string life;                       ///< kHello: run of the service to which `have` refers
  std::map<Channel, std::uint64_t> have;  ///< kHello: versions that the page holds
  bool all_channels = true;               ///< kHello: it names none
  std::vector<Channel> channels;          ///< kHello, kWant: wanted channels
  Channel channel{};                      ///< kResync
  std::optional<double> page_ms;          ///< kHello, kPing, kDrive: send time by its clock
  double linear_mps = 0.0;                ///< kDrive
  double angular_radps = 0.0;             ///< kDrive
};

/// Throws std::invalid_argument with the expected form. Unknown channels are ignored, so that a
/// page of another version works.
ViewerMessage parse_viewer_message(std::string_view text);

}  // namespace topogeo::web
