#include "tcp_stream.hpp"

#include <chrono>
#include <utility>

#include <boost/asio/connect.hpp>
#include <boost/asio/error.hpp>
#include <boost/asio/write.hpp>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

namespace topogeo::sensor_gateway {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

namespace {

/// Longest wait for a connection; a device on the robot answers within milliseconds.
constexpr std::chrono::seconds kLongestConnect{3};
/// A connection ends after this time without an acknowledgement or an answer to a probe.
constexpr int kDeadAfter_ms = 3000;
constexpr int kProbeAfter_s = 1;

void set_option(int socket, int level, int name, int value) {
  static_cast<void>(::setsockopt(socket, level, name, &value, sizeof value));
}

}  // namespace

TcpStream::TcpStream(asio::io_context& context, devices::NetworkAddress address)
    : address_(std::move(address)), resolver_(context), socket_(context), timer_(context) {}

TcpStream::~TcpStream() {
  close();
}

void TcpStream::open(Opened done) {
  timed_out_ = false;
  const std::weak_ptr<int> alive = life_;
  timer_.expires_after(kLongestConnect);
  timer_.async_wait([this, alive](const error_code& error) {
    if (error || alive.expired()) return;
    timed_out_ = true;
    resolver_.cancel();
    error_code ignored;
    socket_.close(ignored);
  });
  const auto finish = [this, alive, done = std::move(done)](const error_code& error) {
    if (alive.expired()) return;
    timer_.cancel();
    open_ = !error && !timed_out_;
    if (open_) watch_link();
    const error_code late = asio::error::timed_out;
    done(timed_out_ ? late : error);
  };
  resolver_.async_resolve(
      address_.host, std::to_string(address_.port.value_or(0)),
      [this, alive, finish](const error_code& error, const tcp::resolver::results_type& found) {
        if (alive.expired()) return;
        if (error || timed_out_) return finish(error);
        asio::async_connect(
            socket_, found,
            [finish](const error_code& failed, const tcp::endpoint& /*to*/) { finish(failed); });
      });
}

asio::ip::address TcpStream::local_address() const {
  error_code ignored;
  return socket_.local_endpoint(ignored).address();
}

asio::ip::address TcpStream::remote_address() const {
  error_code ignored;
  return socket_.remote_endpoint(ignored).address();
}

void TcpStream::watch_link() {
  const int socket = socket_.native_handle();
  set_option(socket, IPPROTO_TCP, TCP_NODELAY, 1);
  set_option(socket, SOL_SOCKET, SO_KEEPALIVE, 1);
  set_option(socket, IPPROTO_TCP, TCP_KEEPIDLE, kProbeAfter_s);
  set_option(socket, IPPROTO_TCP, TCP_KEEPINTVL, kProbeAfter_s);
  set_option(socket, IPPROTO_TCP, TCP_USER_TIMEOUT, kDeadAfter_ms);
}

void TcpStream::close() {
  timer_.cancel();
  resolver_.cancel();
  error_code ignored;
  socket_.close(ignored);
  open_ = false;
}

void TcpStream::read(asio::mutable_buffer buffer, Moved done) {
  socket_.async_read_some(buffer, std::move(done));
}

void TcpStream::write(asio::const_buffer bytes, Moved done) {
  asio::async_write(socket_, bytes, std::move(done));
}

std::string TcpStream::explain(const error_code& error) const {
  if (error == asio::error::eof) return "the device closed the connection";
  if (error == asio::error::timed_out) return "no answer: is the device on and on this network?";
  return error.message();
}

}  // namespace topogeo::sensor_gateway
