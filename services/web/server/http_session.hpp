// One connection: requests, one after the other, until it becomes a WebSocket or ends. Who it is
// and what it may is decided by the header of each request: a body comes only where one is
// expected.
#pragma once

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
  /// It ends in the thread of the connections, whoever lets it go last.
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
  /// Goes on after a pause.
  void pause(void (HttpSession::*then)());
  void read();
  void on_header(beast::error_code error);
  void read_body(std::uint64_t most);
  void on_read(beast::error_code error);
  void answer_read_error(beast::error_code error);
  /// Nothing when the request may go on.
  std::optional<Answer> refusal();
  std::optional<Answer> refusal_of_sender();
  std::optional<Answer> refusal_by_rate();
  Answer refuse(unsigned status, const char* reason, const std::string& sentence);
  /// The largest body that this request may have.
  [[nodiscard]] std::uint64_t most_body_bytes() const;
  /// The header has shown the operator's token, or not.
  void note_token(bool shown);
  void upgrade();
  void route();
  void answer(Request request);
  [[nodiscard]] Respond responder();
  void read_next();
  void send_file(const PageFile& file);
  void send(const Answer& answer);
  void send(std::shared_ptr<Response> response);
  /// Ends the connection when the peer has: what it still sends would make its system drop our
  /// answer.
  void linger();
  [[nodiscard]] std::string header(beast::http::field field) const;

  Connection connection_;
  ServerState& state_;
  RateLimit requests_{200.0, 1500.0};  // without the token
  asio::steady_timer pause_;           // before the next request of who asks too often
  beast::flat_buffer buffer_;
  std::optional<Parser> parser_;
  bool authorized_ = false;  // this request
  bool too_often_ = false;   // the same
  int drained_ = 0;
};

}  // namespace topogeo::web
