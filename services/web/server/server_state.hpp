// What the sessions of a server share. All of it lives in the server's thread.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>

#include "foxglove/foxglove_feed.hpp"
#include "server/board.hpp"
#include "server/page_files.hpp"
#include "server/rate_limit.hpp"
#include "server/tally.hpp"
#include "server/web_types.hpp"

namespace topogeo::web {

class Watcher;

/// What the pages at one address may ask for, all together.
struct PeerLimits {
  RateLimit requests{400.0, 1500.0};  ///< a page asks for some hundred tiles at once
  RateLimit posts{20.0, 40.0};
  int connections = 0;
};

struct ServerState {
  static constexpr int kMostConnections = 256;
  static constexpr int kMostConnectionsOfPeer = 128;
  static constexpr std::size_t kMostPeers = 1024;  ///< remembered without a connection

  ServerConfig config;
  Board& board;
  const PageFiles& files;
  Backend& backend;
  Tally& tally;
  FoxgloveFeed& feed;

  int connections = 0;
  std::map<std::string, PeerLimits> peers;  ///< by address
  std::set<Watcher*> viewers;
  std::uint64_t last_viewer = 0;

  void refuse(std::string_view reason) {
    tally.add(std::string("refused: ") + std::string(reason));
  }
  /// Shows how many watch.
  void show_viewers();
};

}  // namespace topogeo::web
