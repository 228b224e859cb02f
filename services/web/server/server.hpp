// HTTP and WebSocket for pages and programs, in a thread of its own.
#pragma once

#include <cstdint>
#include <memory>

#include "foxglove/foxglove_feed.hpp"
#include "server/channel_hub.hpp"
#include "server/page_files.hpp"
#include "server/tally.hpp"
#include "server/web_types.hpp"

namespace topogeo::web {

class Server {
 public:
  /// All references must outlive it. Throws std::runtime_error naming address, port or file when it
  /// cannot listen or cannot use the certificate.
  Server(const ServerConfig& config, ChannelHub& hub, const PageFiles& files, Backend& backend,
         Tally& tally, FoxgloveFeed& feed);
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;
  /// Ends all connections. No function of the backend is called afterwards.
  ~Server();

  [[nodiscard]] std::uint32_t port() const { return port_; }

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
  std::uint32_t port_ = 0;
};

}  // namespace topogeo::web
