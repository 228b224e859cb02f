// A serial port as a stream of bytes. Works with pseudo-terminals, too.
//
// Boost.Asio does the work: its header-only part is in use anyway, it supports 500,000 baud and
// parity, reads and writes without blocking each other, and reports an unplugged adapter as an
// error of the pending read. libserialport, the other candidate, queries modem lines when it opens
// a port, which a pseudo-terminal does not have.
#pragma once

#include <string>

#include <boost/asio/serial_port.hpp>

#include "port_stream.hpp"

namespace topogeo::sensor_gateway {

class SerialStream final : public PortStream {
 public:
  SerialStream(boost::asio::io_context& context, std::string path);
  /// Closing would wait for unsent bytes, so they are dropped.
  ~SerialStream() override;

  void open(Opened done) override;
  [[nodiscard]] bool is_open() const override { return port_.is_open(); }
  [[nodiscard]] int descriptor() override { return port_.native_handle(); }
  void close() override;
  void read(boost::asio::mutable_buffer buffer, Moved done) override;
  void write(boost::asio::const_buffer bytes, Moved done) override;
  [[nodiscard]] bool drain() override;
  [[nodiscard]] bool has_line() const override { return true; }
  [[nodiscard]] boost::system::error_code change(const devices::LineSettings& settings) override;
  /// Pseudo-terminals have no such signal.
  void set_dtr(bool on) override;
  [[nodiscard]] std::string explain(const boost::system::error_code& error) const override;

 private:
  [[nodiscard]] boost::system::error_code prepare();

  std::string path_;
  boost::asio::serial_port port_;
};

}  // namespace topogeo::sensor_gateway
