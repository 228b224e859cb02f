#include "datagram_stream.hpp"

#include <algorithm>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>

namespace topogeo::sensor_gateway {

namespace asio = boost::asio;
using asio::ip::udp;
using boost::system::error_code;
using devices::EnvelopeKind;

namespace {

/// Bytes that wait for a reader that does not come; more are dropped, as the kernel would.
constexpr std::size_t kMostWaiting = 1'000'000;

}  // namespace

DatagramStream::DatagramStream(asio::io_context& context, devices::NetworkAddress address,
                               std::uint16_t data_port)
    : context_(context),
      commands_(context, std::move(address)),
      data_(context),
      data_port_(data_port) {}

DatagramStream::~DatagramStream() {
  close();
}

void DatagramStream::open(Opened done) {
  const std::weak_ptr<int> alive = life_;
  commands_.open([this, alive, done = std::move(done)](const error_code& error) {
    if (alive.expired()) return;
    const error_code failed = error ? error : begin();
    if (failed) close();
    done(failed);
  });
}

error_code DatagramStream::begin() {
  error_code error;
  device_ = commands_.remote_address();
  data_.open(device_.is_v6() ? udp::v6() : udp::v4(), error);
  if (!error) data_.bind({commands_.local_address(), data_port_}, error);
  const udp::endpoint here = error ? udp::endpoint() : data_.local_endpoint(error);
  if (error) return error;
  ++openings_;
  received_.clear();
  const std::string text = here.address().to_string() + ":" + std::to_string(here.port());
  const std::vector<std::uint8_t> host(text.begin(), text.end());
  put(EnvelopeKind::kHost, host.data(), host.size());
  read_reply();
  read_datagram();
  return {};
}

void DatagramStream::close() {
  ++openings_;
  error_code ignored;
  data_.close(ignored);
  commands_.close();
  reader_ = nullptr;
}

void DatagramStream::read_reply() {
  commands_.read(asio::buffer(reply_),
                 [this, alive = std::weak_ptr<int>(life_), opening = openings_](
                     const error_code& error, std::size_t size) {
                   if (alive.expired() || opening != openings_) return;
                   if (error) return commands_.close();  // write() opens it again
                   put(EnvelopeKind::kReply, reply_.data(), size);
                   read_reply();
                 });
}

void DatagramStream::read_datagram() {
  data_.async_receive_from(asio::buffer(datagram_), sender_,
                           [this, alive = std::weak_ptr<int>(life_), opening = openings_](
                               const error_code& error, std::size_t size) {
                             if (alive.expired() || opening != openings_) return;
                             // An error is that of one datagram: the device will be silent if there
                             // are more.
                             if (!error && sender_.address() == device_) {
                               put(EnvelopeKind::kDatagram, datagram_.data(), size);
                             }
                             read_datagram();
                           });
}

void DatagramStream::put(EnvelopeKind kind, const std::uint8_t* bytes, std::size_t size) {
  if (received_.size() > kMostWaiting) return;
  devices::put_envelope(received_, kind, {bytes, size});
  deliver();
}

void DatagramStream::read(asio::mutable_buffer buffer, Moved done) {
  wanted_ = buffer;
  reader_ = std::move(done);
  deliver();
}

void DatagramStream::deliver() {
  if (!reader_ || received_.empty()) return;
  const std::size_t size = asio::buffer_copy(wanted_, asio::buffer(received_));
  received_.erase(received_.begin(), received_.begin() + static_cast<std::ptrdiff_t>(size));
  asio::post(context_, [done = std::exchange(reader_, nullptr), size] { done({}, size); });
}

void DatagramStream::write(asio::const_buffer bytes, Moved done) {
  if (commands_.is_open()) return commands_.write(bytes, std::move(done));
  const std::weak_ptr<int> alive = life_;
  commands_.open([this, alive, opening = openings_, bytes,
                  done = std::move(done)](const error_code& error) mutable {
    if (alive.expired() || opening != openings_) return;
    if (error) return done(error, 0);
    read_reply();
    commands_.write(bytes, std::move(done));
  });
}

}  // namespace topogeo::sensor_gateway
