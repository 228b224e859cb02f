// Whoever watches by a WebSocket: one message is on its way at a time, and no queue of them; a slow
// link gets what is newest when there is room. What is sent is up to the derived class.
#pragma once

#include <cstdint>
#include <deque>
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
  /// `place` is held as long as the connection lasts.
  Watcher(Connection connection, ServerState& state, std::shared_ptr<void> place);
  Watcher(const Watcher&) = delete;
  Watcher& operator=(const Watcher&) = delete;
  virtual ~Watcher();

  /// `subprotocol` goes into the answer to the handshake; empty: none.
  void start(beast::http::request<beast::http::string_body> request,
             const std::string& subprotocol = {});
  /// Sends the next message, if there is one and none is on its way.
  void pump();
  [[nodiscard]] virtual bool is_operator() const { return false; }

 protected:
  struct Frame {
    std::shared_ptr<const std::string> bytes;
    bool binary = false;
  };

  /// The handshake is done.
  virtual void on_open() = 0;
  virtual void on_text(const std::string& text) = 0;
  /// The connection has ended or is being closed; more than once.
  virtual void on_end() {}
  /// What goes next behind what control() was given; nothing: there is nothing new.
  virtual std::optional<Frame> next_frame() = 0;
  /// How a refusal is worded; `what`: of which order, or empty.
  [[nodiscard]] virtual std::string refusal(const std::string& sentence,
                                            std::string_view what) const = 0;

  void refuse(std::string_view reason, const std::string& sentence, std::string_view what = {});
  /// Goes before all else.
  void control(std::string text);
  [[nodiscard]] ServerState& state() { return state_; }
  [[nodiscard]] const ServerState& state() const { return state_; }
  [[nodiscard]] beast::websocket::stream<Connection, false>& socket() { return socket_; }

 private:
  void read();
  void on_read(beast::error_code error);
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
  bool closing_ = false;
  std::deque<std::string> controls_;
};

}  // namespace topogeo::web
