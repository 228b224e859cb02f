// A page that watches: a WebSocket that is brought up to date whenever it can take more.
//
// One message at a time is on its way. Of the channels that have changed since they were last sent
// the one goes next that was sent longest ago, so that a slow link gets some of everything.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>

#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/websocket/stream.hpp>

#include "connection.hpp"
#include "server_state.hpp"
#include "viewer_message.hpp"

namespace topogeo::web {

class Viewer : public std::enable_shared_from_this<Viewer> {
 public:
  /// `place` is held as long as the connection lasts.
  Viewer(Connection connection, ServerState& state, std::shared_ptr<void> place);
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;
  ~Viewer();

  void start(beast::http::request<beast::http::string_body> request);
  /// Sends the next message, if there is one and none is on its way.
  void pump();
  [[nodiscard]] bool is_operator() const { return operator_; }
  void close();

 private:
  void wait_for_hello();
  void read();
  void on_read(beast::error_code error);
  void on_text(const std::string& text);
  void on_message(const ViewerMessage& message);
  void hello(const ViewerMessage& message);
  void want(const ViewerMessage& message);
  void drive(const ViewerMessage& message);
  void refuse(std::string_view reason, const std::string& sentence, std::string_view what = {});
  void control(std::string text);
  void write(std::shared_ptr<const std::string> text);
  [[nodiscard]] std::size_t next_channel() const;

  ServerState& state_;
  std::shared_ptr<void> place_;
  std::uint64_t number_;
  beast::websocket::stream<Connection, false> socket_;
  asio::steady_timer hello_timer_;
  beast::flat_buffer buffer_;
  RateLimit messages_{50.0, 100.0};
  int refusals_ = 0;
  bool operator_ = false;
  bool ready_ = false;  // the first message has come, or will not
  bool writing_ = false;
  bool closing_ = false;
  std::deque<std::string> controls_;
  std::array<bool, kChannels> wanted_{};
  std::array<std::uint64_t, kChannels> held_{};
  std::array<bool, kChannels> anew_{};           // to be sent whole although nothing has changed
  std::array<std::uint64_t, kChannels> sent_{};  // number of the message that was sent last
  std::uint64_t messages_sent_ = 0;
};

}  // namespace topogeo::web
