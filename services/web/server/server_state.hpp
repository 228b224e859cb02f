// State shared by the sessions of a server. Lives in the connection thread.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>

#include "foxglove/foxglove_feed.hpp"
#include "server/answer_thread.hpp"
#include "server/channel_hub.hpp"
#include "server/page_files.hpp"
#include "server/places.hpp"
#include "server/rate_limit.hpp"
#include "server/tally.hpp"
#include "server/web_types.hpp"

namespace topogeo::web {

class Watcher;

/// Common limits of all pages with the token.
struct OperatorLimits {
  RateLimit requests{400.0, 1500.0};  ///< a page requests some hundred tiles at once
  RateLimit posts{20.0, 40.0};
  RateLimit stops{50.0, 200.0};  ///< Stop and Release only
};

/// Common limits of all pages without the token at one address.
struct PeerLimits {
  RateLimit requests{400.0, 1500.0};
  RateLimit posts{2.0, 10.0};
  RateLimit handshakes{10.0, 60.0};  ///< of TLS: each takes 2 ms in the connection thread
  bool had_token = false;            ///< an operator was here: no limit of handshakes
  int connections = 0;
};

struct ServerState {
  static constexpr std::size_t kMostGuests = 256;
  static constexpr std::size_t kMostOperators = 64;
  static constexpr std::size_t kReservedViewers = 16;  ///< additional places with the token
  static constexpr std::size_t kMostPeers = 1024;      ///< remembered without connections

  ServerConfig config;
  ChannelHub& hub;
  const PageFiles& files;
  Backend& backend;
  Tally& tally;
  FoxgloveFeed& feed;

  Places guests{kMostGuests};        ///< connections without the token
  Places operators{kMostOperators};  ///< connections with the token
  OperatorLimits operator_limits{};
  RateLimit stranger_posts{10.0, 40.0};       ///< without the token, from all addresses together
  std::map<std::string, PeerLimits> peers{};  ///< by address
  std::set<Watcher*> viewers{};
  std::uint64_t last_viewer = 0;

  void refuse(std::string_view reason) {
    tally.add(std::string("refused: ") + std::string(reason));
  }
  /// Publishes the number of viewers.
  void show_viewers();
  /// Sets a value of the hub from the answer thread, because the hub's lock may be held for
  /// long.
  void show(Channel channel, std::string json);

  AnswerThread answers{};
};

}  // namespace topogeo::web
