// The sessions of a server share this state. It lives in the thread of the connections.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>

#include "foxglove/foxglove_feed.hpp"
#include "server/answer_thread.hpp"
#include "server/board.hpp"
#include "server/page_files.hpp"
#include "server/places.hpp"
#include "server/rate_limit.hpp"
#include "server/tally.hpp"
#include "server/web_types.hpp"

namespace topogeo::web {

class Watcher;

/// The rates of all pages with the token together.
struct OperatorLimits {
  RateLimit requests{400.0, 1500.0};  ///< a page asks for some hundred tiles at once
  RateLimit posts{20.0, 40.0};
  RateLimit stops{50.0, 200.0};  ///< Stop and Release, which nothing else uses up
};

/// The rates of all pages without the token at one address together.
struct PeerLimits {
  RateLimit requests{400.0, 1500.0};
  RateLimit posts{2.0, 10.0};
  RateLimit handshakes{10.0, 60.0};  ///< of TLS: each costs 2 ms, in the thread of all connections
  bool had_token = false;            ///< the operator is there: handshakes without a limit
  int connections = 0;
};

struct ServerState {
  static constexpr std::size_t kMostGuests = 256;
  static constexpr std::size_t kMostOperators = 64;
  static constexpr std::size_t kReservedViewers = 16;  ///< with the token, beside all others
  static constexpr std::size_t kMostPeers = 1024;      ///< remembered without a connection

  ServerConfig config;
  Board& board;
  const PageFiles& files;
  Backend& backend;
  Tally& tally;
  FoxgloveFeed& feed;

  Places guests{kMostGuests};        ///< connections without the token
  Places operators{kMostOperators};  ///< with it
  OperatorLimits operator_limits{};
  RateLimit stranger_posts{10.0, 40.0};       ///< without the token, of all addresses together
  std::map<std::string, PeerLimits> peers{};  ///< by address
  std::set<Watcher*> viewers{};
  std::uint64_t last_viewer = 0;

  void refuse(std::string_view reason) {
    tally.add(std::string("refused: ") + std::string(reason));
  }
  /// Shows how many watch.
  void show_viewers();
  /// Sets a value of the board, whose lock may be held for long, from the thread of the answers.
  void show(Channel channel, std::string json);

  AnswerThread answers{};
};

}  // namespace topogeo::web
