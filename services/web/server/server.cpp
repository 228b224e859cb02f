#include "server/server.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include "topogeo/support/format.hpp"
#include "topogeo/support/host.hpp"

#include "server/connection.hpp"
#include "server/http_session.hpp"
#include "server/json_values.hpp"
#include "server/server_state.hpp"
#include "server/watcher.hpp"

namespace topogeo::web {
namespace {

/// Shorter than the silence after which the page considers the connection dead.
constexpr std::chrono::seconds kTimePeriod{1};
constexpr std::chrono::milliseconds kAcceptAgain{100};

}  // namespace

Answer error_answer(unsigned status, const std::string& sentence) {
  Answer answer;
  answer.status = status;
  answer.body = text_of(Json{{"error", sentence}});
  return answer;
}

void ServerState::show_viewers() {
  const auto with_token =
      std::ranges::count_if(viewers, [](const Watcher* viewer) { return viewer->is_operator(); });
  tally.set("viewers", viewers.size());
  show(Channel::kViewers,
       fmt::format(R"({{"viewers":{},"operators":{}}})", viewers.size(), with_token));
}

void ServerState::show(Channel channel, std::string json) {
  answers.post(AnswerThread::Turn::kFirst, [this, channel, json = std::move(json)]() mutable {
    hub.set(channel, std::move(json));
  });
}

struct Server::Impl {
  Impl(const ServerConfig& config, ChannelHub& hub, const PageFiles& files, Backend& backend,
       Tally& tally, FoxgloveFeed& feed)
      : state{config, hub, files, backend, tally, feed},
        acceptor(context),
        retry(context),
        timer(context) {}

  void use_certificate();
  void listen();
  void accept();
  void take(asio::ip::tcp::socket socket);
  void tick();
  void wake();

  // In this order: sessions, which the context owns, use the state and TLS until the context is
  // destroyed.
  ServerState state;
  std::optional<asio::ssl::context> tls;
  asio::io_context context{1};
  asio::ip::tcp::acceptor acceptor;
  asio::steady_timer retry;
  asio::steady_timer timer;
  std::atomic<bool> woken = false;
  std::thread thread;
};

void Server::Impl::use_certificate() {
  const ServerConfig& config = state.config;
  if (config.certificate_file.empty()) return;
  tls.emplace(asio::ssl::context::tls_server);
  tls->set_options(asio::ssl::context::default_workarounds | asio::ssl::context::no_sslv2 |
                   asio::ssl::context::no_sslv3 | asio::ssl::context::no_tlsv1 |
                   asio::ssl::context::no_tlsv1_1);
  beast::error_code error;
  tls->use_certificate_chain_file(config.certificate_file, error);
  if (error) throw std::runtime_error(config.certificate_file + ": " + error.message());
  tls->use_private_key_file(config.key_file, asio::ssl::context::pem, error);
  if (error) throw std::runtime_error(config.key_file + ": " + error.message());
}

void Server::Impl::listen() {
  const ServerConfig& config = state.config;
  try {
    const asio::ip::tcp::endpoint endpoint(asio::ip::make_address(config.address),
                                           static_cast<std::uint16_t>(config.port));
    acceptor.open(endpoint.protocol());
    acceptor.set_option(asio::socket_base::reuse_address(true));
    acceptor.bind(endpoint);
    acceptor.listen();
  } catch (const boost::system::system_error& error) {
    throw std::runtime_error(fmt::format("cannot listen at {} port {}: {}", config.address,
                                         config.port, error.code().message()));
  }
}

void Server::Impl::accept() {
  acceptor.async_accept([this](beast::error_code error, asio::ip::tcp::socket socket) {
    if (error == asio::error::operation_aborted) return;
    if (error) {  // possibly out of file descriptors: an immediate retry would spin
      retry.expires_after(kAcceptAgain);
      retry.async_wait([this](beast::error_code stopped) {
        if (!stopped) accept();
      });
      return;
    }
    take(std::move(socket));
    accept();
  });
}

void Server::Impl::take(asio::ip::tcp::socket socket) {
  beast::error_code error;
  const auto endpoint = socket.remote_endpoint(error);
  if (error) return;
  HttpSession::make(Connection(std::move(socket), tls ? &*tls : nullptr), state,
                    endpoint.address().to_string())
      ->start();
}

void Server::Impl::tick() {
  state.answers.post(AnswerThread::Turn::kFirst, [&hub = state.hub] {
    const double time_s = static_cast<double>(support::wall_clock_ns()) / 1e9;
    hub.set(Channel::kTime,
            fmt::format(R"({{"time_s":{:.3f},"ages_s":{}}})", time_s, hub.ages_s()));
  });
  timer.expires_after(kTimePeriod);
  timer.async_wait([this](beast::error_code error) {
    if (!error) tick();
  });
}

// Other threads make many changes at once: one pass over the viewers is enough.
void Server::Impl::wake() {
  if (woken.exchange(true)) return;
  asio::post(context, [this] {
    woken = false;
    for (Watcher* viewer : state.viewers) viewer->pump();
  });
}

Server::Server(const ServerConfig& config, ChannelHub& hub, const PageFiles& files,
               Backend& backend, Tally& tally, FoxgloveFeed& feed)
    : impl_(std::make_unique<Impl>(config, hub, files, backend, tally, feed)) {
  impl_->use_certificate();
  impl_->listen();
  port_ = impl_->acceptor.local_endpoint().port();
  hub.on_change([impl = impl_.get()](Channel) { impl->wake(); });
  feed.on_change([impl = impl_.get()] { impl->wake(); });
  impl_->accept();
  impl_->tick();
  impl_->thread = std::thread([this] { impl_->context.run(); });
}

Server::~Server() {
  impl_->state.hub.on_change({});
  impl_->state.feed.on_change({});
  impl_->context.stop();
  impl_->thread.join();
  impl_->state.answers.stop();
}

}  // namespace topogeo::web
