// A TCP connection as a stream of bytes: a laser with a network port, or a serial server.
#pragma once

#include <memory>
#include <string>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>

#include "topogeo/devices/network_address.hpp"

#include "port_stream.hpp"

namespace topogeo::sensor_gateway {

class TcpStream final : public PortStream {
 public:
  /// `address` has a port.
  TcpStream(boost::asio::io_context& context, devices::NetworkAddress address);
  ~TcpStream() override;

  /// This host's end and the device's end of the open connection.
  [[nodiscard]] boost::asio::ip::address local_address() const;
  [[nodiscard]] boost::asio::ip::address remote_address() const;

  void open(Opened done) override;
  [[nodiscard]] bool is_open() const override { return open_; }
  [[nodiscard]] int descriptor() override { return socket_.native_handle(); }
  void close() override;
  void read(boost::asio::mutable_buffer buffer, Moved done) override;
  void write(boost::asio::const_buffer bytes, Moved done) override;
  /// The kernel has the bytes, and sends them.
  [[nodiscard]] bool drain() override { return true; }
  [[nodiscard]] bool has_line() const override { return false; }
  [[nodiscard]] boost::system::error_code change(
      const devices::LineSettings& /*settings*/) override {
    return {};
  }
  void set_dtr(bool /*on*/) override {}
  [[nodiscard]] std::string explain(const boost::system::error_code& error) const override;

 private:
  /// Makes a cable that comes out an error within seconds.
  void watch_link();

  devices::NetworkAddress address_;
  boost::asio::ip::tcp::resolver resolver_;
  boost::asio::ip::tcp::socket socket_;
  boost::asio::steady_timer timer_;
  bool open_ = false;
  bool timed_out_ = false;
  std::shared_ptr<int> life_ = std::make_shared<int>(0);  // of the handlers that use this object
};

}  // namespace topogeo::sensor_gateway
