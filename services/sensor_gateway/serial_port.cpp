#include "serial_port.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <deque>
#include <future>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <utility>

#include <boost/asio.hpp>

#include "topogeo/support/host.hpp"

#include "datagram_stream.hpp"
#include "port_stream.hpp"
#include "serial_stream.hpp"
#include "stop_sentry.hpp"
#include "tcp_stream.hpp"

namespace topogeo::sensor_gateway {

namespace asio = boost::asio;
using boost::system::error_code;
using devices::LineOrder;
using std::chrono::milliseconds;

/// All members except `epoch_` belong to the thread.
class SerialPort::Impl {
 public:
  Impl(PortOptions options, std::function<void(PortEvent)> notify)
      : options_(std::move(options)),
        notify_(std::move(notify)),
        stream_(make_port_stream(context_, options_.path, options_.data_port)),
        wait_(options_.first_wait) {
    asio::post(context_, [this] { open(); });
    thread_ = std::thread([this] { context_.run(); });
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() {
    context_.stop();
    thread_.join();
  }

  void write(std::vector<LineOrder> orders, std::uint64_t epoch_opened) {
    asio::post(context_, [this, orders = std::move(orders), epoch_opened]() mutable {
      if (!stream_->is_open() || epoch_opened != epoch_opened_) return;
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
  void opened(const error_code& error);
  void read();
  /// Carries out the next order of the queue, unless a write is under way.
  void carry_out();
  void finish_order();
  void change(const devices::LineSettings& settings);
  void lose(const std::string& why);
  void try_later();
  void notify(PortEvent::Kind kind, std::string why = {}, std::vector<std::uint8_t> bytes = {});

  PortOptions options_;
  std::function<void(PortEvent)> notify_;
  asio::io_context context_;
  asio::executor_work_guard<asio::io_context::executor_type> work_{context_.get_executor()};
  std::unique_ptr<PortStream> stream_;
  std::optional<StopSentry> sentry_;  // declared after the stream, so that it ends before it
  asio::steady_timer retry_{context_};
  milliseconds wait_;
  std::atomic<std::uint64_t> epoch_ = 0;
  std::uint64_t epoch_opened_ = 0;
  std::array<std::uint8_t, 4096> buffer_{};
  std::deque<LineOrder> queue_;
  std::uint64_t finished_ = 0;  // orders carried out since the port was opened
  bool writing_ = false;
  std::vector<std::shared_ptr<std::promise<void>>> waiters_;
  std::thread thread_;
};

void SerialPort::Impl::open() {
  stream_->open([this](const error_code& error) { opened(error); });
}

void SerialPort::Impl::opened(const error_code& error) {
  if (error) {
    notify(PortEvent::Kind::kNotOpened,
           options_.path + ": cannot open: " + stream_->explain(error));
    try_later();
    return;
  }
  epoch_opened_ = ++epoch_;
  finished_ = 0;
  notify(PortEvent::Kind::kOpened);
  if (!options_.stop_bytes.empty()) {
    try {
      sentry_.emplace(stream_->descriptor(), options_.stop_bytes, options_.stop_after);
    } catch (const std::system_error& no_process) {
      lose(no_process.what());
      return;
    }
  }
  read();
}

void SerialPort::Impl::read() {
  stream_->read(asio::buffer(buffer_),
                [this, opened = epoch_opened_](const error_code& error, std::size_t size) {
                  if (opened != epoch_opened_ || !stream_->is_open())
                    return;  // the port was closed after this read began
                  if (error) {
                    lose(stream_->explain(error));
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
      continue;  // a failure has emptied the queue
    }
    if (const auto dtr = std::exchange(queue_.front().dtr, std::nullopt)) {
      stream_->set_dtr(*dtr);
    }
    if (queue_.front().bytes.empty()) {
      finish_order();
      continue;
    }
    writing_ = true;
    if (sentry_) sentry_->alive();
    stream_->write(asio::buffer(queue_.front().bytes),
                   [this, opened = epoch_opened_](const error_code& error, std::size_t) {
                     if (opened != epoch_opened_ || !stream_->is_open()) return;
                     writing_ = false;
                     if (error) {
                       lose(stream_->explain(error));
                       return;
                     }
                     finish_order();
                     carry_out();
                   });
  }
  if (writing_ || waiters_.empty()) return;
  if (stream_->is_open() && !stream_->drain()) lose("accepts no data");
  for (const auto& waiter : std::exchange(waiters_, {})) waiter->set_value();
}

void SerialPort::Impl::finish_order() {
  queue_.pop_front();
  ++finished_;
  if (queue_.empty()) notify(PortEvent::Kind::kWritten);
}

void SerialPort::Impl::change(const devices::LineSettings& settings) {
  if (!stream_->has_line()) return;
  if (!stream_->drain()) {
    lose("accepts no data");
    return;
  }
  if (const error_code error = stream_->change(settings)) {
    lose("refuses " + std::to_string(settings.baud) + " baud: " + error.message());
    return;
  }
  ++epoch_;
}

void SerialPort::Impl::lose(const std::string& why) {
  sentry_.reset();
  stream_->close();
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
  notify_({kind, support::monotonic_ns(), epoch_, std::move(why), std::move(bytes), finished_});
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

std::unique_ptr<PortStream> make_port_stream(asio::io_context& context, const std::string& path,
                                             std::uint16_t data_port) {
  if (!devices::is_network_address(path)) return std::make_unique<SerialStream>(context, path);
  devices::NetworkAddress address = devices::network_address(path);
  if (!address.port) throw std::invalid_argument("'" + path + "': expected a port after the host");
  if (address.datagrams) {
    return std::make_unique<DatagramStream>(context, std::move(address), data_port);
  }
  return std::make_unique<TcpStream>(context, std::move(address));
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
