// A connection to a device, which moves bytes: a serial port, a TCP connection ("tcp://host:port"),
// or a TCP connection for commands with datagrams for data ("udp://host:port").
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include <boost/asio/buffer.hpp>
#include <boost/asio/error.hpp>
#include <boost/asio/io_context.hpp>

#include "topogeo/devices/serial_driver.hpp"

namespace topogeo::sensor_gateway {

/// Lives in the thread of its context, which calls the handlers. A handler may be called after
/// close().
class PortStream {
 public:
  using Opened = std::function<void(const boost::system::error_code&)>;
  using Moved = std::function<void(const boost::system::error_code&, std::size_t bytes)>;

  PortStream() = default;
  PortStream(const PortStream&) = delete;
  PortStream& operator=(const PortStream&) = delete;
  PortStream(PortStream&&) = delete;
  PortStream& operator=(PortStream&&) = delete;
  virtual ~PortStream() = default;

  /// Opens and configures it. Calls `done` once, at once or later.
  virtual void open(Opened done) = 0;
  [[nodiscard]] virtual bool is_open() const = 0;
  /// The open port's.
  [[nodiscard]] virtual int descriptor() = 0;
  /// Drops bytes that were not sent.
  virtual void close() = 0;
  virtual void read(boost::asio::mutable_buffer buffer, Moved done) = 0;
  /// Writes all of them.
  virtual void write(boost::asio::const_buffer bytes, Moved done) = 0;
  /// Waits until all bytes have left; false when that takes too long.
  [[nodiscard]] virtual bool drain() = 0;
  /// It has a rate and a parity: change() takes effect and drops received bytes.
  [[nodiscard]] virtual bool has_line() const = 0;
  [[nodiscard]] virtual boost::system::error_code change(const devices::LineSettings& settings) = 0;
  virtual void set_dtr(bool on) = 0;
  /// A text for an error of this kind of connection.
  [[nodiscard]] virtual std::string explain(const boost::system::error_code& error) const = 0;
};

/// The connection for a path that begins with "tcp://" or "udp://", else a serial port.
/// `data_port`: this host's port for datagrams; 0: any free one. Throws std::invalid_argument like
/// devices::network_address().
std::unique_ptr<PortStream> make_port_stream(boost::asio::io_context& context,
                                             const std::string& path, std::uint16_t data_port);

}  // namespace topogeo::sensor_gateway
