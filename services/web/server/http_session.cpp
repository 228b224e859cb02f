#include "server/http_session.hpp"

#include <algorithm>
#include <array>
#include <chrono>

#include <boost/beast/http/error.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/beast/websocket/rfc6455.hpp>

#include "foxglove/foxglove_viewer.hpp"
#include "server/access.hpp"
#include "server/viewer.hpp"

namespace topogeo::web {

namespace http = beast::http;

namespace {

constexpr std::chrono::seconds kIdle{30};  // between two requests, and for one to come or go
constexpr std::chrono::seconds kLinger{2};
constexpr std::size_t kDrained_bytes = 65536;  // at a time ...
constexpr int kMostDrained = 64;               // ... and so often
constexpr std::uint32_t kMostRequestHeader_bytes = 8192;
constexpr std::uint64_t kMostBody_bytes = 65536;
/// A drawing with all that it may have, each number with all of its digits.
constexpr std::uint64_t kMostDrawing_bytes = std::uint64_t{8} << 20U;
constexpr std::chrono::seconds kUpload{120};  // for a body that is larger than usual

/// Of what comes to a path.
std::uint64_t most_bytes(std::string_view path) {
  if (path == kMapUploadPath) return kMostMapFile_bytes;
  if (path == "/api/drawing" || path == "/api/floor") return kMostDrawing_bytes;
  return kMostBody_bytes;
}

/// What browsers are told of each answer: the page takes nothing from elsewhere, and is framed by
/// nobody.
constexpr const char* kContentPolicy =
    "default-src 'self'; img-src 'self' data: blob:; style-src 'self' 'unsafe-inline'; "
    "connect-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'";

}  // namespace

HttpSession::HttpSession(Connection connection, ServerState& state, std::string peer)
    : connection_(std::move(connection)), state_(state), peer_(std::move(peer)) {
  ++state_.connections;
  ++state_.peers[peer_].connections;
}

HttpSession::~HttpSession() {
  --state_.connections;
  --state_.peers[peer_].connections;
  // Who connects anew for each request has no other limits.
  if (state_.peers.size() <= ServerState::kMostPeers) return;
  std::erase_if(state_.peers, [](const auto& peer) { return peer.second.connections == 0; });
}

void HttpSession::start() {
  if (!connection_.has_tls()) {
    read();
    return;
  }
  connection_.expires_after(kIdle);
  connection_.async_handshake([self = shared_from_this()](beast::error_code error) {
    if (error) {
      self->state_.refuse("no TLS");
    } else {
      self->read();
    }
  });
}

void HttpSession::read() {
  parser_.emplace();
  parser_->header_limit(kMostRequestHeader_bytes);
  parser_->body_limit(kMostMapFile_bytes);
  connection_.expires_after(kIdle);
  http::async_read_header(connection_, buffer_, *parser_,
                          [self = shared_from_this()](beast::error_code error, std::size_t) {
                            self->on_header(error);
                          });
}

// What is larger than orders are is only read for those who may send it.
void HttpSession::on_header(beast::error_code error) {
  if (error) {
    answer_read_error(error);
    return;
  }
  const std::string target(parser_->get().target());
  const bool large = parser_->content_length().value_or(0) > kMostBody_bytes;
  const std::uint64_t most = most_bytes(std::string_view(target).substr(0, target.find('?')));
  if (large && most > kMostBody_bytes) {
    if (const auto refused = refusal()) {
      send(*refused);
      return;
    }
    admitted_ = true;
  }
  if (parser_->content_length().value_or(0) > most) {
    answer_read_error(http::error::body_limit);
    return;
  }
  parser_->body_limit(admitted_ ? most : kMostBody_bytes);
  connection_.expires_after(admitted_ ? kUpload : kIdle);
  http::async_read(connection_, buffer_, *parser_,
                   [self = shared_from_this()](beast::error_code failed, std::size_t) {
                     self->on_read(failed);
                   });
}

void HttpSession::on_read(beast::error_code error) {
  if (error) {
    answer_read_error(error);
    return;
  }
  state_.tally.add("requests");
  const bool admitted = std::exchange(admitted_, false);
  if (const auto refused = admitted ? std::optional<Answer>() : refusal()) {
    send(*refused);
  } else if (beast::websocket::is_upgrade(parser_->get())) {
    upgrade();
  } else {
    route();
  }
}

// What is no HTTP ends the connection; what is too much gets an answer first.
void HttpSession::answer_read_error(beast::error_code error) {
  if (error == http::error::end_of_stream || error == beast::error::timeout ||
      error.category() != http::make_error_code(http::error::bad_method).category()) {
    return;
  }
  const bool large = error == http::error::body_limit || error == http::error::header_limit;
  state_.refuse(large ? "too large" : "no HTTP");
  auto response = std::make_shared<Response>();
  response->result(large ? http::status::payload_too_large : http::status::bad_request);
  response->body() = error_answer(0, large ? "the request is too large" : "this is no HTTP").body;
  response->keep_alive(false);
  send(response);
}

std::string HttpSession::header(http::field field) const {
  const auto value = parser_->get()[field];
  return {value.data(), value.size()};
}

std::optional<Answer> HttpSession::refusal() {
  const auto refuse = [this](unsigned status, const char* reason, const std::string& sentence) {
    state_.refuse(reason);
    return error_answer(status, sentence);
  };
  const auto& request = parser_->get();
  PeerLimits& limits = state_.peers[peer_];
  const double now_s = state_.config.clock_s();
  if (!limits.requests.take(now_s)) return refuse(429, "too often", "too many requests");
  const std::string host = header(http::field::host);
  if (!is_own_host(host, state_.config.hosts)) {
    return refuse(403, "foreign host", "this is not the host '" + host + "'; see --host");
  }
  const std::string origin = header(http::field::origin);
  if (!is_own_origin(origin, host, state_.config.origins)) {
    return refuse(403, "foreign origin", "pages of " + origin + " may not use this service");
  }
  if (request.method() == http::verb::get || request.method() == http::verb::head) return {};
  if (request.method() != http::verb::post) {
    return refuse(405, "method", "expected GET or POST");
  }
  // The token first: who has none learns nothing else.
  const bool computes_only = request.target() == "/api/room_shapes";
  if (!computes_only && !is_authorized(header(http::field::authorization), state_.config.token)) {
    return refuse(401, "no token", "this needs the operator's token");
  }
  if (!limits.posts.take(now_s)) return refuse(429, "too often", "too many orders");
  return {};
}

void HttpSession::upgrade() {
  // Programs that speak Foxglove's protocol ask for "/".
  const std::string foxglove = foxglove_subprotocol(header(http::field::sec_websocket_protocol));
  if (foxglove.empty() && parser_->get().target() != "/ws") {
    send(error_answer(404, "the WebSocket is at /ws"));
    return;
  }
  if (state_.viewers.size() >= state_.config.most_viewers) {
    state_.refuse("too many viewers");
    send(error_answer(503, "too many viewers"));
    return;
  }
  connection_.expires_never();
  std::shared_ptr<Watcher> watcher;
  if (foxglove.empty()) {
    watcher = std::make_shared<Viewer>(std::move(connection_), state_, shared_from_this());
  } else {
    watcher = std::make_shared<FoxgloveViewer>(std::move(connection_), state_, shared_from_this());
  }
  watcher->start(parser_->release(), foxglove);
}

void HttpSession::route() {
  const auto& request = parser_->get();
  const std::string target(request.target());
  const std::size_t question = target.find('?');
  Request out;
  out.post = request.method() == http::verb::post;
  out.path = target.substr(0, question);
  if (question != std::string::npos) out.query = target.substr(question + 1);
  out.body = request.body();
  out.authorized = is_authorized(header(http::field::authorization), state_.config.token);
  if (!out.post) {
    if (const PageFile* file = state_.files.find(out.path)) {
      send_file(*file);
      return;
    }
  }
  connection_.expires_never();  // the answer may take as long as that of another service
  state_.backend.handle(
      out, [self = shared_from_this(), executor = connection_.get_executor()](Answer answer) {
        asio::post(executor, [self, answer = std::move(answer)] { self->send(answer); });
      });
}

void HttpSession::send_file(const PageFile& file) {
  auto response = std::make_shared<Response>();
  response->set(http::field::etag, file.etag);
  response->set(http::field::cache_control, "no-cache");
  response->set(http::field::vary, "Accept-Encoding");
  if (header(http::field::if_none_match) == file.etag) {
    response->result(http::status::not_modified);
    send(response);
    return;
  }
  response->set(http::field::content_type, file.content_type);
  const bool compressed = !file.compressed.empty() &&
                          header(http::field::accept_encoding).find("gzip") != std::string::npos;
  if (compressed) response->set(http::field::content_encoding, "gzip");
  response->body() = compressed ? file.compressed : file.content;
  send(response);
}

void HttpSession::send(const Answer& answer) {
  auto response = std::make_shared<Response>();
  response->result(answer.status);
  response->set(http::field::content_type, answer.content_type);
  response->set(http::field::cache_control,
                answer.cacheable ? "public, max-age=31536000, immutable" : "no-store");
  if (answer.status == 401) response->set(http::field::www_authenticate, "Bearer");
  response->body() = answer.body;
  send(response);
}

void HttpSession::send(std::shared_ptr<Response> response) {
  const bool keep = parser_->is_header_done() && parser_->get().keep_alive() && parser_->is_done();
  response->version(11);
  response->keep_alive(keep);
  response->set("Content-Security-Policy", kContentPolicy);
  response->set("X-Content-Type-Options", "nosniff");
  response->set("Referrer-Policy", "no-referrer");
  if (parser_->is_header_done() && parser_->get().method() == http::verb::head) {
    response->body().clear();
  }
  response->prepare_payload();
  connection_.expires_after(kIdle);
  Response& sent = *response;
  http::async_write(connection_, sent,
                    [self = shared_from_this(), response = std::move(response), keep](
                        beast::error_code error, std::size_t) {
                      if (error) return;
                      if (keep) {
                        self->read();
                      } else {
                        self->linger();
                      }
                    });
}

void HttpSession::linger() {
  beast::error_code ignored;
  connection_.socket().shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
  connection_.expires_after(kLinger);
  buffer_.clear();
  connection_.async_read_some(buffer_.prepare(kDrained_bytes),
                              [self = shared_from_this()](beast::error_code error, std::size_t) {
                                if (error || ++self->drained_ > kMostDrained) {
                                  self->connection_.close();
                                } else {
                                  self->linger();
                                }
                              });
}

}  // namespace topogeo::web
