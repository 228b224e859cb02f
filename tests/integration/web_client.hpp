// A client of the web service: requests, a WebSocket, and a page's model of the channels.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace topogeo::test {

struct HttpReply {
  int status = 0;    ///< 0: the connection ended without an answer
  std::string head;  ///< status line and headers
  std::string body;
};

using Headers = std::vector<std::pair<std::string, std::string>>;

/// Sends one request on a connection of its own to 127.0.0.1. The Host header is right unless
/// `headers` has another one.
HttpReply http_request(std::uint32_t port, const std::string& method, const std::string& target,
                       const Headers& headers = {}, const std::string& body = {});
HttpReply http_get(std::uint32_t port, const std::string& target);
/// Posts with the token; empty: without one.
HttpReply http_post(std::uint32_t port, const std::string& target, const std::string& token,
                    const std::string& body = "{}");

/// Sends raw bytes, and returns the answer until the other side closes or is silent for `quiet`.
std::string exchange_bytes(std::uint32_t port, const std::string& bytes,
                           std::chrono::milliseconds quiet);

/// A connection on which only the test sends.
class RawConnection {
 public:
  explicit RawConnection(std::uint32_t port);
  RawConnection(const RawConnection&) = delete;
  RawConnection& operator=(const RawConnection&) = delete;
  ~RawConnection();

  void send(const std::string& bytes) const;
  /// The bytes up to the end of an answer's headers, or of the connection.
  [[nodiscard]] std::string receive_head() const;
  /// The bytes up to the end of the connection.
  [[nodiscard]] std::string receive_all() const;
  /// Whether the service closes it within hang_limit().
  [[nodiscard]] bool ends() const;

 private:
  int socket_;
};

/// A page's clock, for driving commands.
inline double page_ms() {
  return std::chrono::duration<double, std::milli>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// The header with a page's token for opening a WebSocket.
Headers token_header(const std::string& token);

class WebSocketClient {
 public:
  /// Throws std::runtime_error with the status line when it is refused.
  explicit WebSocketClient(std::uint32_t port, const Headers& headers = {});
  WebSocketClient(const WebSocketClient&) = delete;
  WebSocketClient& operator=(const WebSocketClient&) = delete;
  /// Drops the connection, without a closing message.
  ~WebSocketClient();

  void send_text(const std::string& text);
  void send(const nlohmann::json& json) { send_text(json.dump()); }
  /// The next message, text or binary; empty on a timeout or when the connection has ended.
  std::optional<std::string> receive(std::chrono::milliseconds timeout);
  [[nodiscard]] bool ended() const { return ended_; }
  /// The server's handshake: status line and headers.
  [[nodiscard]] const std::string& handshake() const { return handshake_; }
  /// For tests that stop reading and shrink buffers, which looks like a bad link to the other side.
  [[nodiscard]] int socket() const { return socket_; }

 private:
  bool fill(std::chrono::steady_clock::time_point end);
  void send_frame(unsigned opcode, const std::string& payload);

  int socket_ = -1;
  std::string handshake_;
  std::string buffer_;
  std::string message_;  // unfinished
  bool ended_ = false;
};

/// Data that a page holds. Deltas on a version other than the one held throw std::runtime_error.
class PageModel {
 public:
  /// Takes messages until `condition` holds; false on a timeout.
  template <class Condition>
  bool wait_for(WebSocketClient& socket, const Condition& condition,
                std::chrono::milliseconds timeout) {
    const auto end = std::chrono::steady_clock::now() + timeout;
    while (!condition()) {
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
          end - std::chrono::steady_clock::now());
      if (left.count() <= 0) return false;
      const auto text = socket.receive(left);
      if (!text) return condition();
      take(*text);
    }
    return true;
  }
  void take(const std::string& text);

  [[nodiscard]] bool has(const std::string& channel) const { return versions.contains(channel); }

  std::map<std::string, std::uint64_t> versions;
  std::map<std::string, nlohmann::json> values;
  std::map<std::string, std::map<std::string, nlohmann::json>> tables;
  std::vector<nlohmann::json> others;  ///< welcome, refused, pong
  int snapshots = 0;                   ///< of tables
};

}  // namespace topogeo::test
