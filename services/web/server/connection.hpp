// A viewer's connection, with or without TLS: one type for both, so that Beast is compiled once.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <utility>  // before Asio of 1.74, whose awaitable.hpp lacks it

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/beast/core/bind_handler.hpp>
#include <boost/beast/core/role.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/ssl/ssl_stream.hpp>

namespace topogeo::web {

namespace asio = boost::asio;
namespace beast = boost::beast;

class Connection {
 public:
  using executor_type = beast::tcp_stream::executor_type;

  /// `tls` may be null; otherwise it must outlive this object.
  Connection(asio::ip::tcp::socket socket, asio::ssl::context* tls)
      : streams_(std::make_unique<Streams>(std::move(socket), tls)) {}

  executor_type get_executor() { return streams_->tcp.get_executor(); }
  asio::ip::tcp::socket& socket() { return streams_->tcp.socket(); }
  [[nodiscard]] bool has_tls() const { return streams_->tls.has_value(); }
  void expires_after(std::chrono::steady_clock::duration time) {
    streams_->tcp.expires_after(time);
  }
  void expires_never() { streams_->tcp.expires_never(); }

  template <class Handler>
  void async_handshake(Handler&& handler) {
    streams_->tls->async_handshake(asio::ssl::stream_base::server, std::forward<Handler>(handler));
  }
  template <class Buffers, class Handler>
  void async_read_some(const Buffers& buffers, Handler&& handler) {
    if (streams_->tls) {
      streams_->tls->async_read_some(buffers, std::forward<Handler>(handler));
    } else {
      streams_->tcp.async_read_some(buffers, std::forward<Handler>(handler));
    }
  }
  template <class Buffers, class Handler>
  void async_write_some(const Buffers& buffers, Handler&& handler) {
    if (streams_->tls) {
      streams_->tls->async_write_some(buffers, std::forward<Handler>(handler));
    } else {
      streams_->tcp.async_write_some(buffers, std::forward<Handler>(handler));
    }
  }

  /// Closes both directions without waiting for the peer.
  void close() {
    beast::error_code ignored;
    socket().shutdown(asio::ip::tcp::socket::shutdown_both, ignored);
    socket().close(ignored);
  }

 private:
  struct Streams {
    Streams(asio::ip::tcp::socket socket, asio::ssl::context* context) : tcp(std::move(socket)) {
      if (context != nullptr) tls.emplace(tcp, *context);
    }
    beast::tcp_stream tcp;
    std::optional<beast::ssl_stream<beast::tcp_stream&>> tls;
  };
  std::unique_ptr<Streams> streams_;
};

// Functions that Beast requires for closing the WebSocket of a custom stream.
inline void beast_close_socket(Connection& connection) {
  connection.close();
}
inline void teardown(beast::role_type, Connection& connection, beast::error_code& error) {
  error = {};
  connection.close();
}
template <class Handler>
void async_teardown(beast::role_type, Connection& connection, Handler&& handler) {
  const auto executor = connection.get_executor();
  connection.close();
  asio::post(executor,
             beast::bind_front_handler(std::forward<Handler>(handler), beast::error_code{}));
}

}  // namespace topogeo::web
