// Whoever watches by a WebSocket: one message is on its way at a time, and no queue of them; a slow
// link gets what is newest when there is room. The derived class decides what is sent, and the
// thread of the answers makes it: here only bytes come and go.
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
  /// Messages that follow each other.
  struct Made {
    std::deque<Frame> frames;
    std::uint64_t version = 0;  ///< that the watcher holds then
  };
  /// Makes messages in the thread of the answers; empty: there is nothing new.
  using Work = std::function<Made()>;

  /// `place` is held as long as the connection lasts. `has_token`: it has shown the operator's.
  Watcher(Connection connection, ServerState& state, std::shared_ptr<void> place, bool has_token);
  Watcher(const Watcher&) = delete;
  Watcher& operator=(const Watcher&) = delete;
  virtual ~Watcher();

  /// `subprotocol` goes into the answer to the handshake; empty: none.
  void start(beast::http::request<beast::http::string_body> request,
             const std::string& subprotocol = {});
  /// Sends the next message, if there is one and none is on its way.
  void pump();
  /// It has shown the operator's token.
  [[nodiscard]] bool is_operator() const { return operator_; }

 protected:
  /// The handshake is done.
  virtual void on_open() = 0;
  virtual void on_text(const std::string& text) = 0;
  /// The connection has ended or is being closed; more than once.
  virtual void on_end() {}
  /// The next work; its messages go behind those of control().
  virtual Work next_work() = 0;
  /// Its messages are made and go next.
  virtual void on_made(std::uint64_t version) = 0;
  /// How a refusal is worded; `what`: of which order, or empty.
  [[nodiscard]] virtual std::string refusal(const std::string& sentence,
                                            std::string_view what) const = 0;

  void refuse(std::string_view reason, const std::string& sentence, std::string_view what = {});
  /// Goes before all else.
  void control(std::string text);
  /// Drops the messages of next_work() that are not on their way yet.
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
  bool making_ = false;  // next_work() is with the thread of the answers
  bool closing_ = false;
  bool operator_;
  std::deque<std::string> controls_;
  std::deque<Frame> frames_;
};

}  // namespace topogeo::web
