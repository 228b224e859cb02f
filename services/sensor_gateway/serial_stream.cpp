#include "serial_stream.hpp"

#include <cerrno>
#include <chrono>
#include <thread>
#include <utility>

#include <boost/asio/error.hpp>
#include <boost/asio/write.hpp>
#include <fcntl.h>
#include <linux/serial.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <termios.h>

#include "topogeo/support/line_rate.hpp"

namespace topogeo::sensor_gateway {

namespace asio = boost::asio;
using boost::system::error_code;
using std::chrono::milliseconds;

namespace {

/// Longer than the longest telegram takes at 9600 baud.
constexpr milliseconds kLongestDrain{2000};
constexpr milliseconds kDrainPoll{1};

/// Pseudo-terminals have no parity and reject every setting but none; the program at their far end
/// works without it.
bool is_pseudo_terminal(int fd) {
  constexpr unsigned kFirstMajor = 136;  // of the Unix98 ones, see devices.txt of Linux
  constexpr unsigned kLastMajor = 143;
  struct stat status {};
  if (::fstat(fd, &status) != 0 || !S_ISCHR(status.st_mode)) return false;
  const unsigned number = major(status.st_rdev);
  return number >= kFirstMajor && number <= kLastMajor;
}

asio::serial_port_base::parity::type asio_parity(devices::Parity parity) {
  switch (parity) {
    case devices::Parity::kEven:
      return asio::serial_port_base::parity::even;
    case devices::Parity::kOdd:
      return asio::serial_port_base::parity::odd;
    case devices::Parity::kNone:
      break;
  }
  return asio::serial_port_base::parity::none;
}

/// Makes the port's driver deliver bytes at once; USB adapters otherwise collect them for up to 16
/// ms. Ports without this setting work without it.
void ask_for_low_latency(int fd) {
  serial_struct settings{};
  if (::ioctl(fd, TIOCGSERIAL, &settings) != 0) return;
  settings.flags |= ASYNC_LOW_LATENCY;
  static_cast<void>(::ioctl(fd, TIOCSSERIAL, &settings));
}

}  // namespace

SerialStream::SerialStream(asio::io_context& context, std::string path)
    : path_(std::move(path)), port_(context) {}

SerialStream::~SerialStream() {
  if (port_.is_open()) static_cast<void>(::tcflush(port_.native_handle(), TCOFLUSH));
}

void SerialStream::open(Opened done) {
  error_code error;
  port_.open(path_, error);
  if (!error) error = prepare();
  error_code ignored;
  if (error) port_.close(ignored);
  done(error);
}

/// Locks the port, because two programs on one port would each get half of the bytes. Terminal
/// programs use the same lock; TIOCEXCL does not bind the superuser.
error_code SerialStream::prepare() {
  const int fd = port_.native_handle();
  if (::flock(fd, LOCK_EX | LOCK_NB) != 0) {
    return {errno == EWOULDBLOCK ? EBUSY : errno, boost::system::system_category()};
  }
  ask_for_low_latency(fd);
  error_code error;
  port_.set_option(asio::serial_port_base::character_size(8), error);
  if (!error) {
    port_.set_option(
        asio::serial_port_base::flow_control(asio::serial_port_base::flow_control::none), error);
  }
  if (!error) {
    port_.set_option(asio::serial_port_base::stop_bits(asio::serial_port_base::stop_bits::one),
                     error);
  }
  static_cast<void>(::tcflush(fd, TCIOFLUSH));  // left over from before
  return error;
}

void SerialStream::close() {
  error_code ignored;
  static_cast<void>(::tcflush(port_.native_handle(), TCOFLUSH));  // closing would wait for it
  port_.close(ignored);
}

void SerialStream::read(asio::mutable_buffer buffer, Moved done) {
  port_.async_read_some(buffer, std::move(done));
}

void SerialStream::write(asio::const_buffer bytes, Moved done) {
  asio::async_write(port_, bytes, std::move(done));
}

error_code SerialStream::change(const devices::LineSettings& settings) {
  error_code error;
  port_.set_option(asio::serial_port_base::baud_rate(settings.baud), error);
  if (error && support::set_line_rate(port_.native_handle(), settings.baud)) error = {};
  if (!error) {
    port_.set_option(asio::serial_port_base::parity(asio_parity(settings.parity)), error);
    if (error && is_pseudo_terminal(port_.native_handle())) error = {};
  }
  if (!error) static_cast<void>(::tcflush(port_.native_handle(), TCIFLUSH));
  return error;
}

void SerialStream::set_dtr(bool on) {
  const int signal = TIOCM_DTR;
  static_cast<void>(::ioctl(port_.native_handle(), on ? TIOCMBIS : TIOCMBIC, &signal));
}

/// tcdrain alone would not detect that it takes too long; only tcdrain waits for the bytes inside
/// the hardware.
bool SerialStream::drain() {
  const auto end = std::chrono::steady_clock::now() + kLongestDrain;
  const int fd = port_.native_handle();
  int waiting = 0;
  while (::ioctl(fd, TIOCOUTQ, &waiting) == 0 && waiting > 0) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(kDrainPoll);
  }
  return ::tcdrain(fd) == 0 || errno == EINTR;
}

std::string SerialStream::explain(const error_code& error) const {
  // Asio returns the error of tcgetattr for a file that is no terminal.
  if (error == error_code(ENOTTY, boost::system::system_category())) return "not a serial port";
  return error == asio::error::eof ? "unplugged" : error.message();
}

}  // namespace topogeo::sensor_gateway
