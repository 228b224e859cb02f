// One connection: requests, one after the other, until it becomes a WebSocket or ends.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/string_body.hpp>

#include "server/connection.hpp"
#include "server/server_state.hpp"

namespace topogeo::web {

class HttpSession : public std::enable_shared_from_this<HttpSession> {
 public:
  HttpSession(Connection connection, ServerState& state, std::string peer);
  HttpSession(const HttpSession&) = delete;
  HttpSession& operator=(const HttpSession&) = delete;
  ~HttpSession();

  void start();

 private:
  using Parser = beast::http::request_parser<beast::http::string_body>;
  using Response = beast::http::response<beast::http::string_body>;

  void read();
  void on_header(beast::error_code error);
  void on_read(beast::error_code error);
  void answer_read_error(beast::error_code error);
  /// Nothing when the request may go on.
  std::optional<Answer> refusal();
  void upgrade();
  void route();
  void send_file(const PageFile& file);
  void send(const Answer& answer);
  void send(std::shared_ptr<Response> response);
  /// Ends the connection when the peer has: what it still sends would make its system drop our
  /// answer.
  void linger();
  [[nodiscard]] std::string header(beast::http::field field) const;

  Connection connection_;
  ServerState& state_;
  std::string peer_;
  beast::flat_buffer buffer_;
  std::optional<Parser> parser_;
  bool admitted_ = false;  // refusal() has let the request pass already
  int drained_ = 0;
};

}  // namespace topogeo::web
