#include "http_server.hpp"

#include <chrono>
#include <stdexcept>
#include <thread>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>

namespace topogeo::service {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using asio::ip::tcp;

/// Timeout for a peer that sends nothing or takes nothing.
constexpr std::chrono::seconds kPeerPatience{5};
/// Peers at a time; further ones are rejected to save memory for the robot.
constexpr int kMostPeers = 16;
constexpr std::uint32_t kMostHeader_bytes = 8192;

/// One request and its answer.
class Exchange : public std::enable_shared_from_this<Exchange> {
 public:
  Exchange(tcp::socket socket, const HttpPage& page, std::shared_ptr<void> place)
      : stream_(std::move(socket)), page_(page), place_(std::move(place)) {
    parser_.header_limit(kMostHeader_bytes);
    parser_.body_limit(0);
  }

  void start() {
    stream_.expires_after(kPeerPatience);
    http::async_read_header(stream_, buffer_, parser_,
                            [self = shared_from_this()](beast::error_code error, std::size_t) {
                              if (!error) self->answer();
                            });
  }

 private:
  void answer() {
    const bool known = parser_.get().target() == page_.path;
    const bool get = parser_.get().method() == http::verb::get;
    response_.result(!get    ? http::status::method_not_allowed
                     : known ? http::status::ok
                             : http::status::not_found);
    response_.set(http::field::content_type, page_.content_type);
    if (get && known) response_.body() = page_.body();
    response_.keep_alive(false);
    response_.prepare_payload();
    http::async_write(stream_, response_,
                      [self = shared_from_this()](beast::error_code, std::size_t) {
                        beast::error_code ignored;
                        self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
                      });
  }

  beast::tcp_stream stream_;
  beast::flat_buffer buffer_;
  http::request_parser<http::empty_body> parser_;
  http::response<http::string_body> response_;
  const HttpPage& page_;
  std::shared_ptr<void> place_;  // its place among the peers of the server
};

}  // namespace

struct HttpServer::Impl {
  Impl(const tcp::endpoint& endpoint, HttpPage what)
      : acceptor(context, endpoint), page(std::move(what)) {}

  void accept() {
    acceptor.async_accept([this](beast::error_code error, tcp::socket socket) {
      if (error == asio::error::operation_aborted) return;
      if (!error && peers < kMostPeers) {
        ++peers;
        const std::shared_ptr<void> place(nullptr, [this](void*) { --peers; });
        std::make_shared<Exchange>(std::move(socket), page, place)->start();
      }
      accept();
    });
  }

  // Declared first, because the members below use `peers` while they are destroyed.
  int peers = 0;
  asio::io_context context{1};
  tcp::acceptor acceptor;
  HttpPage page;
  std::thread thread;
};

HttpServer::HttpServer(const std::string& address, std::uint32_t port, HttpPage page) {
  try {
    const tcp::endpoint endpoint(asio::ip::make_address(address), static_cast<std::uint16_t>(port));
    impl_ = std::make_unique<Impl>(endpoint, std::move(page));
  } catch (const boost::system::system_error& error) {
    throw std::runtime_error(error.code().message());
  }
  impl_->accept();
  impl_->thread = std::thread([this] { impl_->context.run(); });
}

HttpServer::~HttpServer() {
  impl_->context.stop();
  impl_->thread.join();
}

std::uint32_t HttpServer::port() const {
  return impl_->acceptor.local_endpoint().port();
}

}  // namespace topogeo::service
