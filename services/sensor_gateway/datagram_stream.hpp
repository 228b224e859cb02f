// A device that takes commands over TCP and sends its data as datagrams: both links as one stream
// of envelopes (devices/envelope.hpp). The first envelope has the address for the datagrams.
// Written bytes go to the connection for commands, which is opened again when the device has closed
// it. Datagrams of other hosts are dropped.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <boost/asio/ip/udp.hpp>

#include "topogeo/devices/envelope.hpp"

#include "tcp_stream.hpp"

namespace topogeo::sensor_gateway {

class DatagramStream final : public PortStream {
 public:
  /// `address` has a port; `data_port`: this host's, 0: any free one.
  DatagramStream(boost::asio::io_context& context, devices::NetworkAddress address,
                 std::uint16_t data_port);
  ~DatagramStream() override;

  void open(Opened done) override;
  [[nodiscard]] bool is_open() const override { return data_.is_open(); }
  [[nodiscard]] int descriptor() override { return commands_.descriptor(); }
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
  [[nodiscard]] std::string explain(const boost::system::error_code& error) const override {
    return commands_.explain(error);
  }

 private:
  /// Binds the port for datagrams, and begins to read both links.
  [[nodiscard]] boost::system::error_code begin();
  void read_reply();
  void read_datagram();
  void put(devices::EnvelopeKind kind, const std::uint8_t* bytes, std::size_t size);
  /// Gives bytes to the reader that waits for them.
  void deliver();

  boost::asio::io_context& context_;
  TcpStream commands_;
  boost::asio::ip::udp::socket data_;
  boost::asio::ip::udp::endpoint sender_;
  boost::asio::ip::address device_;
  std::uint16_t data_port_;
  std::uint64_t openings_ = 0;  // handlers of an earlier one do nothing
  std::array<std::uint8_t, 65'536> datagram_{};
  std::array<std::uint8_t, 4096> reply_{};
  std::vector<std::uint8_t> received_;
  boost::asio::mutable_buffer wanted_;
  Moved reader_;                                          // waits; empty: none does
  std::shared_ptr<int> life_ = std::make_shared<int>(0);  // of the handlers that use this object
};

}  // namespace topogeo::sensor_gateway
