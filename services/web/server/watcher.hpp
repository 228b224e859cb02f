// A WebSocket client that watches. Only one message is under way at a time, without a queue: a slow
// link gets the newest state when it has room. The derived class chooses the messages and the
// answer thread makes them; this class only transfers bytes.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/websocket/stream.hpp>

#include "server/connection.hpp"
#include "server/server_state.hpp"

namespace topogeo::web {

class Watcher : public std::enable_shared_from_this<Watcher> {
 public:
  struct Frame {
    std::shared_ptr<const std::string> bytes;
    bool binary = false;
  };
  /// Consecutive messages.
  struct Made {
    std::deque<Frame> frames;
    std::uint64_t version = 0;  ///< version that the watcher then holds
  };
  /// Makes messages in the answer thread; an empty result means no news.
  using Work = std::function<Made()>;

  /// `place` is held for the life of the connection. `has_token`: the request had the operator's
  /// token.
  Watcher(Connection connection, ServerState& state, std::shared_ptr<void> place, bool has_token);
  Watcher(const Watcher&) = delete;
  Watcher& operator=(const Watcher&) = delete;
  virtual ~Watcher();

  /// `subprotocol` goes into the answer to the handshake; empty: none.
  void start(beast::http::request<beast::http::string_body> request,
             const std::string& subprotocol = {});
  /// Sends the next message, if there is one and none is under way.
  void pump();
  /// Whether it has shown the operator's token.
  [[nodiscard]] bool is_operator() const { return operator_; }

 protected:
  /// The handshake is done.
  virtual void on_open() = 0;
  virtual void on_text(const std::string& text) = 0;
  /// The connection has ended or is being closed; may be called more than once.
  virtual void on_end() {}
  /// The next work; its messages follow those of control().
  virtual Work next_work() = 0;
  /// The messages are made and will be sent next.
  virtual void on_made(std::uint64_t version) = 0;
  /// Text of a refusal; `what`: the refused order, or empty.
  [[nodiscard]] virtual std::string refusal(const std::string& sentence,
                                            std::string_view what) const = 0;

  void refuse(std::string_view reason, const std::string& sentence, std::string_view what = {});
  /// Sent before all other messages.
  void control(std::string text);
  /// Drops the messages of next_work() that are not yet under way.
  void drop_frames() { frames_.clear(); }
  void set_operator() { operator_ = true; }
  [[nodiscard]] ServerState& state() { return state_; }
  [[nodiscard]] const ServerState& state() const { return state_; }
  [[nodiscard]] beast::websocket::stream<Connection, false>& socket() { return socket_; }

 private:
  void read();
  void on_read(beast::error_code error);
  void make();
  void take(Made made);
  void write(Frame frame);
  void close();

  ServerState& state_;
  std::shared_ptr<void> place_;
  beast::websocket::stream<Connection, false> socket_;
  beast::flat_buffer buffer_;
  RateLimit messages_{50.0, 100.0};
  int refusals_ = 0;
  bool open_ = false;
  bool writing_ = false;
  bool making_ = false;  // next_work() runs in the answer thread
  bool closing_ = false;
  bool operator_;
  std::deque<std::string> controls_;
  std::deque<Frame> frames_;
};

}  // namespace topogeo::web
