#include "serial_port.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <deque>
#include <future>
#include <stdexcept>
#include <thread>
#include <utility>

#include <boost/asio.hpp>
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
using devices::LineOrder;
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

std::int64_t steady_now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// All members except `epoch_` belong to the thread.
class SerialPort::Impl {
 public:
  Impl(PortOptions options, std::function<void(PortEvent)> notify)
      : options_(std::move(options)), notify_(std::move(notify)), wait_(options_.first_wait) {
    asio::post(context_, [this] { open(); });
    thread_ = std::thread([this] { context_.run(); });
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() {
    context_.stop();
    thread_.join();
    // Closing would wait for unsent bytes.
    if (port_.is_open()) static_cast<void>(::tcflush(port_.native_handle(), TCOFLUSH));
  }

  void write(std::vector<LineOrder> orders, std::uint64_t epoch_opened) {
    asio::post(context_, [this, orders = std::move(orders), epoch_opened]() mutable {
      if (!port_.is_open() || epoch_opened != epoch_opened_) return;
      for (LineOrder& order : orders) queue_.push_back(std::move(order));
      carry_out();
    });
  }

  std::future<void> written() {
    auto promise = std::make_shared<std::promise<void>>();
    std::future<void> future = promise->get_future();
    asio::post(context_, [this, promise = std::move(promise)] {
      waiters_.push_back(promise);
      carry_out();
    });
    return future;
  }

  [[nodiscard]] std::uint64_t epoch() const { return epoch_; }

 private:
  void open();
  void prepare(error_code& error);
  void read();
  /// Carries out the next order of the queue, unless a write is under way.
  void carry_out();
  void finish_order();
  void change(const devices::LineSettings& settings);
  /// Pseudo-terminals have no such signal.
  void set_dtr(bool on);
  [[nodiscard]] bool drain();
  void lose(const std::string& why);
  void try_later();
  void notify(PortEvent::Kind kind, std::string why = {}, std::vector<std::uint8_t> bytes = {});

  PortOptions options_;
  std::function<void(PortEvent)> notify_;
  asio::io_context context_;
  asio::executor_work_guard<asio::io_context::executor_type> work_{context_.get_executor()};
  asio::serial_port port_{context_};
  asio::steady_timer retry_{context_};
  milliseconds wait_;
  std::atomic<std::uint64_t> epoch_ = 0;
  std::uint64_t epoch_opened_ = 0;
  std::array<std::uint8_t, 4096> buffer_{};
  std::deque<LineOrder> queue_;
  std::uint64_t finished_ = 0;  // orders, since the port was opened
  bool writing_ = false;
  std::vector<std::shared_ptr<std::promise<void>>> waiters_;
  std::thread thread_;
};

void SerialPort::Impl::open() {
  error_code error;
  port_.open(options_.path, error);
  if (!error) prepare(error);
  if (error) {
    error_code ignored;
    port_.close(ignored);
    // Asio returns the error of tcgetattr for a file that is no terminal.
    const bool is_other = error == error_code(ENOTTY, boost::system::system_category());
    notify(PortEvent::Kind::kNotOpened,
           options_.path + ": cannot open: " + (is_other ? "not a serial port" : error.message()));
    try_later();
    return;
  }
  epoch_opened_ = ++epoch_;
  finished_ = 0;
  notify(PortEvent::Kind::kOpened);
  read();
}

/// Locks the port, because two programs on one port would each get half of the bytes. Terminal
/// programs use the same lock; TIOCEXCL does not bind the superuser.
void SerialPort::Impl::prepare(error_code& error) {
  const int fd = port_.native_handle();
  if (::flock(fd, LOCK_EX | LOCK_NB) != 0) {
    error = error_code(errno == EWOULDBLOCK ? EBUSY : errno, boost::system::system_category());
    return;
  }
  ask_for_low_latency(fd);
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
}

void SerialPort::Impl::read() {
  port_.async_read_some(asio::buffer(buffer_), [this, opened = epoch_opened_](
                                                   const error_code& error, std::size_t size) {
    if (opened != epoch_opened_ || !port_.is_open()) return;  // event of a port that was closed
    if (error) {
      lose(error == asio::error::eof ? "unplugged" : error.message());
      return;
    }
    wait_ = options_.first_wait;
    notify(PortEvent::Kind::kBytes, {},
           {buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(size)});
    read();
  });
}

void SerialPort::Impl::carry_out() {
  while (!writing_ && !queue_.empty()) {
    if (const auto settings = std::exchange(queue_.front().settings, std::nullopt)) {
      change(*settings);
      continue;  // the queue is empty when that failed
    }
    if (const auto dtr = std::exchange(queue_.front().dtr, std::nullopt)) set_dtr(*dtr);
    if (queue_.front().bytes.empty()) {
      finish_order();
      continue;
    }
    writing_ = true;
    asio::async_write(port_, asio::buffer(queue_.front().bytes),
                      [this, opened = epoch_opened_](const error_code& error, std::size_t) {
                        if (opened != epoch_opened_ || !port_.is_open()) return;
                        writing_ = false;
                        if (error) {
                          lose(error.message());
                          return;
                        }
                        finish_order();
                        carry_out();
                      });
  }
  if (writing_ || waiters_.empty()) return;
  if (port_.is_open() && !drain()) lose("accepts no data");
  for (const auto& waiter : std::exchange(waiters_, {})) waiter->set_value();
}

void SerialPort::Impl::finish_order() {
  queue_.pop_front();
  ++finished_;
  if (queue_.empty()) notify(PortEvent::Kind::kWritten);
}

void SerialPort::Impl::change(const devices::LineSettings& settings) {
  if (!drain()) {
    lose("accepts no data");
    return;
  }
  error_code error;
  port_.set_option(asio::serial_port_base::baud_rate(settings.baud), error);
  if (error && support::set_line_rate(port_.native_handle(), settings.baud)) error = {};
  if (!error) {
    port_.set_option(asio::serial_port_base::parity(asio_parity(settings.parity)), error);
    if (error && is_pseudo_terminal(port_.native_handle())) error = {};
  }
  if (error) {
    lose("refuses " + std::to_string(settings.baud) + " baud: " + error.message());
    return;
  }
  static_cast<void>(::tcflush(port_.native_handle(), TCIFLUSH));
  ++epoch_;
}

void SerialPort::Impl::set_dtr(bool on) {
  const int signal = TIOCM_DTR;
  static_cast<void>(::ioctl(port_.native_handle(), on ? TIOCMBIS : TIOCMBIC, &signal));
}

/// Waits until all bytes have left the port; false when that takes too long, which tcdrain alone
/// would not detect. Only tcdrain waits for the bytes inside the hardware.
bool SerialPort::Impl::drain() {
  const auto end = std::chrono::steady_clock::now() + kLongestDrain;
  const int fd = port_.native_handle();
  int waiting = 0;
  while (::ioctl(fd, TIOCOUTQ, &waiting) == 0 && waiting > 0) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(kDrainPoll);
  }
  return ::tcdrain(fd) == 0 || errno == EINTR;
}

void SerialPort::Impl::lose(const std::string& why) {
  error_code ignored;
  static_cast<void>(::tcflush(port_.native_handle(), TCOFLUSH));  // closing would wait for it
  port_.close(ignored);
  queue_.clear();
  writing_ = false;
  ++epoch_;
  notify(PortEvent::Kind::kLost, options_.path + ": " + why);
  for (const auto& waiter : std::exchange(waiters_, {})) waiter->set_value();
  try_later();
}

void SerialPort::Impl::try_later() {
  retry_.expires_after(wait_);
  wait_ = std::min(2 * wait_, options_.longest_wait);
  retry_.async_wait([this](const error_code& error) {
    if (!error) open();
  });
}

void SerialPort::Impl::notify(PortEvent::Kind kind, std::string why,
                              std::vector<std::uint8_t> bytes) {
  notify_({kind, steady_now_ns(), epoch_, std::move(why), std::move(bytes), finished_});
}

SerialPort::SerialPort(const PortOptions& options, std::function<void(PortEvent)> notify) {
  if (options.path.empty()) throw std::invalid_argument("path: expected a port, got nothing");
  if (options.first_wait.count() <= 0 || options.longest_wait < options.first_wait) {
    throw std::invalid_argument("first_wait, longest_wait: expected 0 < first <= longest, got " +
                                std::to_string(options.first_wait.count()) + " and " +
                                std::to_string(options.longest_wait.count()) + " ms");
  }
  impl_ = std::make_unique<Impl>(options, std::move(notify));
}

SerialPort::~SerialPort() = default;

void SerialPort::write(std::vector<LineOrder> orders, std::uint64_t epoch_opened) {
  impl_->write(std::move(orders), epoch_opened);
}

std::uint64_t SerialPort::epoch() const {
  return impl_->epoch();
}

bool SerialPort::wait_written(milliseconds timeout) {
  return impl_->written().wait_for(timeout) == std::future_status::ready;
}

}  // namespace topogeo::sensor_gateway
