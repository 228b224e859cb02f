#include "server/http_session.hpp"

#include <algorithm>
#include <chrono>
#include <utility>
#include <vector>

#include <boost/asio/dispatch.hpp>
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

constexpr std::string_view kPageProtocol = "topogeo";
constexpr std::chrono::seconds kIdle{30};  // between two requests, and for receiving or sending one
constexpr std::chrono::seconds kLinger{2};
constexpr std::chrono::milliseconds kPause{250};  // after a request that came too soon
constexpr std::size_t kDrained_bytes = 65536;     // at a time ...
constexpr int kMostDrained = 64;                  // ... and at most so often
constexpr std::uint32_t kMostRequestHeader_bytes = 8192;
constexpr std::chrono::seconds kUpload{120};  // for a body larger than usual

std::string_view path_of(std::string_view target) {
  return target.substr(0, target.find('?'));
}

bool stops_or_releases(const Route* route) {
  return route != nullptr &&
         (route->handling == Handling::kStop || route->handling == Handling::kRelease);
}

/// Browser policy for each answer: the page loads nothing from elsewhere, and no site may frame it.
constexpr const char* kContentPolicy =
    "default-src 'self'; img-src 'self' data: blob:; style-src 'self' 'unsafe-inline'; "
    "connect-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'";

}  // namespace

std::shared_ptr<HttpSession> HttpSession::make(Connection connection, ServerState& state,
                                               std::string peer) {
  const auto executor = connection.get_executor();
  return {new HttpSession(std::move(connection), state, std::move(peer)),
          [executor](HttpSession* session) {
            asio::dispatch(executor, [owned = std::unique_ptr<HttpSession>(session)] {});
          }};
}

HttpSession::HttpSession(Connection connection, ServerState& state, std::string peer)
    : Guest(std::move(peer)),
      connection_(std::move(connection)),
      state_(state),
      pause_(connection_.get_executor()) {
  if (!state_.guests.enter(*this)) state_.refuse("too many connections");
  ++state_.peers[address()].connections;
}

HttpSession::~HttpSession() {
  Places::leave(*this);
  --state_.peers[address()].connections;
  // A peer that opens a new connection for each request must meet the same limits.
  if (state_.peers.size() <= ServerState::kMostPeers) return;
  std::erase_if(state_.peers, [](const auto& peer) { return peer.second.connections == 0; });
}

void HttpSession::start() {
  if (connection_.has_tls()) {
    shake_hands();
  } else {
    read();
  }
}

void HttpSession::shake_hands() {
  PeerLimits& peer = state_.peers[address()];
  if (!peer.had_token && !peer.handshakes.take(state_.config.clock_s())) {
    pause(&HttpSession::shake_hands);
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
  parser_->body_limit(kMostMapFile_bytes);  // the header sets the limit of each request
  connection_.expires_after(kIdle);
  http::async_read_header(connection_, buffer_, *parser_,
                          [self = shared_from_this()](beast::error_code error, std::size_t) {
                            self->on_header(error);
                          });
}

void HttpSession::on_header(beast::error_code error) {
  if (error) {
    answer_read_error(error);
    return;
  }
  state_.tally.add("requests");
  stops_ = state_.backend.stops();
  const std::string target(parser_->get().target());
  const bool post = parser_->get().method() == http::verb::post;
  route_ = state_.backend.route(post ? Method::kPost : Method::kGet, path_of(target));
  note_token(shows_token(header(http::field::authorization),
                         header(http::field::sec_websocket_protocol), state_.config.token));
  if (const auto refused = refusal()) {
    send(*refused);
  } else if (parser_->is_done()) {
    on_read({});
  } else {
    read_body(most_body_bytes());
  }
}

void HttpSession::note_token(bool shown) {
  if (shown && !authorized_) state_.operators.enter(*this);
  if (!shown && authorized_) state_.guests.enter(*this);
  if (shown) state_.peers[address()].had_token = true;
  authorized_ = shown;
  too_often_ = false;
  Places::touch(*this);
}

std::uint64_t HttpSession::most_body_bytes() const {
  if (parser_->get().method() != http::verb::post) return kNoBody_bytes;
  return route_ != nullptr ? route_->most_body_bytes : kMostBody_bytes;
}

void HttpSession::read_body(std::uint64_t most) {
  if (parser_->content_length().value_or(0) > most) {
    answer_read_error(http::error::body_limit);
    return;
  }
  parser_->body_limit(most);
  connection_.expires_after(most > kMostBody_bytes ? kUpload : kIdle);
  http::async_read(connection_, buffer_, *parser_,
                   [self = shared_from_this()](beast::error_code failed, std::size_t) {
                     self->on_read(failed);
                   });
}

void HttpSession::on_read(beast::error_code error) {
  if (error) {
    answer_read_error(error);
  } else if (beast::websocket::is_upgrade(parser_->get())) {
    upgrade();
  } else {
    route();
  }
}

// Invalid HTTP ends the connection; an oversized request gets an answer first.
void HttpSession::answer_read_error(beast::error_code error) {
  if (error == http::error::end_of_stream || error == beast::error::timeout ||
      error.category() != http::make_error_code(http::error::bad_method).category()) {
    return;
  }
  const bool large = error == http::error::body_limit || error == http::error::header_limit;
  state_.refuse(large ? "too large" : "no HTTP");
  auto response = std::make_shared<Response>();
  response->result(large ? http::status::payload_too_large : http::status::bad_request);
  response->body() = error_answer(0, large ? "the request is too large" : "no HTTP request").body;
  response->keep_alive(false);
  send(response);
}

std::string HttpSession::header(http::field field) const {
  const auto value = parser_->get()[field];
  return {value.data(), value.size()};
}

Answer HttpSession::refuse(unsigned status, const char* reason, const std::string& sentence) {
  state_.refuse(reason);
  return error_answer(status, sentence);
}

std::optional<Answer> HttpSession::refusal() {
  if (auto refused = refusal_of_sender()) return refused;
  return refusal_by_rate();
}

std::optional<Answer> HttpSession::refusal_of_sender() {
  const auto& request = parser_->get();
  const std::string host = header(http::field::host);
  if (!is_own_host(host, state_.config.hosts)) {
    return refuse(403, "foreign host", "unknown host '" + host + "'; see --host");
  }
  const std::string origin = header(http::field::origin);
  if (!is_own_origin(origin, host, state_.config.origins)) {
    return refuse(403, "foreign origin", "pages of " + origin + " may not use this service");
  }
  if (request.method() == http::verb::get || request.method() == http::verb::head) return {};
  if (request.method() != http::verb::post) {
    return refuse(405, "method", "expected GET or POST");
  }
  // Check the token first, so that a peer without it learns nothing else.
  const bool open = route_ != nullptr && route_->access == Access::kAnybody &&
                    std::string_view(request.target().data(), request.target().size()) ==
                        route_->path;  // without a query
  if (!authorized_ && !open) {
    return refuse(401, "no token", "this needs the operator's token");
  }
  return {};
}

// Requests with the token never share a limit with those without, not even from one address.
std::optional<Answer> HttpSession::refusal_by_rate() {
  const auto& request = parser_->get();
  const double now_s = state_.config.clock_s();
  const bool post = request.method() == http::verb::post;
  OperatorLimits& own = state_.operator_limits;
  if (authorized_ && stops_or_releases(route_)) {
    if (!own.stops.take(now_s)) return refuse(429, "too often", "too many orders to stop");
    return {};
  }
  PeerLimits& peer = state_.peers[address()];
  too_often_ = authorized_ ? !own.requests.take(now_s)
                           : !(requests_.take(now_s) && peer.requests.take(now_s));
  if (too_often_) return refuse(429, "too often", "too many requests");
  if (!post) return {};
  too_often_ = authorized_ ? !own.posts.take(now_s)
                           : !(peer.posts.take(now_s) && state_.stranger_posts.take(now_s));
  if (too_often_) return refuse(429, "too often", "too many orders");
  return {};
}

void HttpSession::upgrade() {
  // Programs that speak Foxglove's protocol request "/".
  const std::string offered = header(http::field::sec_websocket_protocol);
  const std::string foxglove = foxglove_subprotocol(offered);
  if (foxglove.empty() && parser_->get().target() != "/ws") {
    send(error_answer(404, "the WebSocket is at /ws"));
    return;
  }
  const std::vector<std::string_view> names = names_in(offered);
  const std::size_t reserved = authorized_ ? ServerState::kReservedViewers : 0;
  if (state_.viewers.size() >= state_.config.most_viewers + reserved) {
    state_.refuse("too many viewers");
    send(error_answer(503, "too many viewers"));
    return;
  }
  Places::leave(*this);
  connection_.expires_never();
  std::shared_ptr<Watcher> watcher;
  std::string chosen = foxglove;
  if (foxglove.empty()) {
    if (std::ranges::find(names, kPageProtocol) != names.end()) chosen = kPageProtocol;
    watcher =
        std::make_shared<Viewer>(std::move(connection_), state_, shared_from_this(), authorized_);
  } else {
    watcher = std::make_shared<FoxgloveViewer>(std::move(connection_), state_, shared_from_this(),
                                               authorized_);
  }
  watcher->start(parser_->release(), chosen);
}

void HttpSession::route() {
  const auto& request = parser_->get();
  const std::string target(request.target());
  const std::size_t question = target.find('?');
  Request out;
  out.post = request.method() == http::verb::post;
  out.path = target.substr(0, question);
  if (question != std::string::npos) out.query = target.substr(question + 1);
  out.authorized = authorized_;
  out.stops = stops_;
  const auto page = request["X-Topogeo-Page"];
  out.page.assign(page.data(), std::min<std::size_t>(page.size(), kLongestPageId));
  if (!out.post) {
    if (const PageFile* file = state_.files.find(out.path)) {
      send_file(*file);
      return;
    }
  }
  out.body = std::move(parser_->get().body());
  answer(std::move(out));
}

void HttpSession::answer(Request request) {
  connection_.expires_never();  // the answer may wait for another service
  const Handling handling = route_ != nullptr ? route_->handling : Handling::kAtOnce;
  if (handling == Handling::kStop) {
    state_.backend.stop(request.page, responder());
  } else if (handling == Handling::kRelease) {
    state_.backend.release_stop(request.page, responder());
  } else {
    const auto turn = authorized_ ? AnswerThread::Turn::kFirst : AnswerThread::Turn::kLater;
    state_.answers.post(turn, [&backend = state_.backend, respond = responder(),
                               request = std::move(request)] { backend.handle(request, respond); });
  }
}

Respond HttpSession::responder() {
  return [self = shared_from_this(), executor = connection_.get_executor()](Answer answer) {
    asio::post(executor, [self, answer = std::move(answer)] { self->send(answer); });
  };
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
                        self->read_next();
                      } else {
                        self->linger();
                      }
                    });
}

// A peer that sends requests too often waits, which costs no work.
void HttpSession::read_next() {
  Places::touch(*this);
  if (!too_often_ || authorized_) {
    read();
    return;
  }
  pause(&HttpSession::read);
}

void HttpSession::pause(void (HttpSession::*then)()) {
  pause_.expires_after(kPause);
  pause_.async_wait([self = shared_from_this(), then](beast::error_code error) {
    if (!error) (self.get()->*then)();
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
