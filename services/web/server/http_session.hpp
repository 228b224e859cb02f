// One connection: requests in turn, until it becomes a WebSocket or ends. The header of each
// request decides its sender and rights: a body is read only where one is expected.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/string_body.hpp>

#include "server/connection.hpp"
#include "server/server_state.hpp"

namespace topogeo::web {

class HttpSession : public std::enable_shared_from_this<HttpSession>, private Places::Guest {
 public:
  /// Destroyed in the connection thread, wherever the last reference is released.
  static std::shared_ptr<HttpSession> make(Connection connection, ServerState& state,
                                           std::string peer);
  HttpSession(const HttpSession&) = delete;
  HttpSession& operator=(const HttpSession&) = delete;
  ~HttpSession();

  void start();

 private:
  using Parser = beast::http::request_parser<beast::http::string_body>;
  using Response = beast::http::response<beast::http::string_body>;

  HttpSession(Connection connection, ServerState& state, std::string peer);
  void give_way() override { connection_.close(); }
  void shake_hands();
  /// Continues after a pause.
  void pause(void (HttpSession::*then)());
  void read();
  void on_header(beast::error_code error);
  void read_body(std::uint64_t most);
  void on_read(beast::error_code error);
  void answer_read_error(beast::error_code error);
  /// Nothing when the request may continue.
  std::optional<Answer> refusal();
  std::optional<Answer> refusal_of_sender();
  std::optional<Answer> refusal_by_rate();
  Answer refuse(unsigned status, const char* reason, const std::string& sentence);
  /// The largest body allowed for this request.
  [[nodiscard]] std::uint64_t most_body_bytes() const;
  /// Records whether the header contained the operator's token.
  void note_token(bool shown);
  void upgrade();
  void route();
  void answer(Request request);
  [[nodiscard]] Respond responder();
  void read_next();
  void send_file(const PageFile& file);
  void send(const Answer& answer);
  void send(std::shared_ptr<Response> response);
  /// Ends the connection after the peer has: data still under way would make the peer's system drop
  /// our answer.
  void linger();
  [[nodiscard]] std::string header(beast::http::field field) const;

  Connection connection_;
  ServerState& state_;
  RateLimit requests_{200.0, 1500.0};  // without the token
  asio::steady_timer pause_;           // before the next request of a peer that sends too often
  beast::flat_buffer buffer_;
  std::optional<Parser> parser_;
  const Route* route_ = nullptr;  // of this request
  bool authorized_ = false;       // for this request
  bool too_often_ = false;        // for this request
  std::uint64_t stops_ = 0;       // before this request
  int drained_ = 0;
};

}  // namespace topogeo::web
