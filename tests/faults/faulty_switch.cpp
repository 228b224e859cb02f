// An Ethernet switch between TAP devices that loses, delays, reorders and repeats frames on
// command, for kernels without netem. It makes a device for each host named; the caller moves the
// devices into the network namespaces of the hosts. Commands are read from its standard input, a
// line each:
//
//   clear | loss PERCENT | delay MS | reorder PERCENT | duplicate PERCENT | cut HOST | join HOST
//
// PERCENT is of all frames; a reordered one arrives 20 ms later than those behind it.
#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <map>
#include <optional>
#include <queue>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <linux/if.h>
#include <linux/if_tun.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace {

using Clock = std::chrono::steady_clock;
using Frame = std::vector<std::uint8_t>;
using Address = std::array<std::uint8_t, 6>;

/// Later than the frames behind it, which are sent within a few milliseconds.
constexpr std::chrono::milliseconds kReordered{20};
/// Larger than any frame of a device, because the MTU is 1500.
constexpr std::size_t kMaxFrame = 2048;
/// Queue limit: a second at a gigabit. Frames beyond it are lost, as in a switch.
constexpr std::size_t kMaxWaiting = 80'000;

[[noreturn]] void fail(const std::string& what) {
  throw std::system_error(errno, std::generic_category(), what);
}

int open_device(const std::string& name) {
  const int device = ::open("/dev/net/tun", O_RDWR | O_NONBLOCK | O_CLOEXEC);  // NOLINT: vararg
  if (device < 0) fail("/dev/net/tun");
  ifreq request{};
  if (name.size() >= sizeof request.ifr_name) throw std::invalid_argument("name '" + name + "'");
  std::copy(name.begin(), name.end(), request.ifr_name);
  request.ifr_flags = IFF_TAP | IFF_NO_PI;
  if (::ioctl(device, TUNSETIFF, &request) < 0) fail("device " + name);  // NOLINT: vararg
  return device;
}

struct Port {
  std::string name;
  int device = -1;
  bool cut = false;
};

struct Waiting {
  Clock::time_point due;
  std::uint64_t number;  // keeps the order of frames that are due at the same time
  std::size_t to;
  Frame frame;
  bool operator>(const Waiting& other) const {
    return due != other.due ? due > other.due : number > other.number;
  }
};

class FaultySwitch {
 public:
  explicit FaultySwitch(const std::vector<std::string>& hosts) {
    for (const std::string& host : hosts) ports_.push_back({host, open_device(host)});
  }

  /// Runs until the standard input ends.
  void run() {
    std::vector<pollfd> waits = {{STDIN_FILENO, POLLIN, 0}};
    for (const Port& port : ports_) waits.push_back({port.device, POLLIN, 0});
    for (;;) {
      if (::poll(waits.data(), waits.size(), timeout_ms()) < 0 && errno != EINTR) fail("poll");
      if (waits[0].revents != 0 && !read_orders()) return;
      for (std::size_t i = 0; i < ports_.size(); ++i) {
        if (waits[i + 1].revents != 0) read_frames(i);
      }
      send_due();
    }
  }

 private:
  [[nodiscard]] int timeout_ms() const {
    if (waiting_.empty()) return -1;
    const auto rest =
        std::chrono::ceil<std::chrono::milliseconds>(waiting_.top().due - Clock::now());
    return std::max(0, static_cast<int>(rest.count()));
  }

  bool read_orders() {
    std::array<char, 256> text{};
    const ssize_t size = ::read(STDIN_FILENO, text.data(), text.size());
    if (size <= 0) return false;
    orders_.append(text.data(), static_cast<std::size_t>(size));
    for (auto end = orders_.find('\n'); end != std::string::npos; end = orders_.find('\n')) {
      obey(orders_.substr(0, end));
      orders_.erase(0, end + 1);
    }
    return true;
  }

  void obey(const std::string& line) {
    std::istringstream words(line);
    std::string order;
    std::string what;
    words >> order >> what;
    if (order == "clear") {
      loss_ = reorder_ = duplicate_ = 0.0;
      delay_ = {};
      for (Port& port : ports_) port.cut = false;
    } else if (order == "cut" || order == "join") {
      for (Port& port : ports_) {
        if (port.name == what) port.cut = order == "cut";
      }
    } else if (order == "delay") {
      delay_ = std::chrono::milliseconds(std::stoi(what));
    } else if (order == "loss") {
      loss_ = std::stod(what) / 100.0;
    } else if (order == "reorder") {
      reorder_ = std::stod(what) / 100.0;
    } else if (order == "duplicate") {
      duplicate_ = std::stod(what) / 100.0;
    } else {
      throw std::invalid_argument("order '" + line + "'");
    }
  }

  void read_frames(std::size_t from) {
    Frame frame(kMaxFrame);
    for (;;) {
      const ssize_t size = ::read(ports_[from].device, frame.data(), frame.size());
      if (size < 0 && (errno == EAGAIN || errno == EIO)) return;  // EIO: the device is down
      if (size < 0) fail("read " + ports_[from].name);
      if (size < 14 || ports_[from].cut) continue;
      forward(from, Frame(frame.begin(), frame.begin() + size));
    }
  }

  void forward(std::size_t from, const Frame& frame) {
    Address to{};
    Address source{};
    std::copy_n(frame.begin(), to.size(), to.begin());
    std::copy_n(frame.begin() + 6, source.size(), source.begin());
    known_[source] = from;
    const bool everybody = (to[0] & 1U) != 0;
    const auto known = known_.find(to);
    for (std::size_t port = 0; port < ports_.size(); ++port) {
      if (port == from) continue;
      if (!everybody && known != known_.end() && known->second != port) continue;
      if (happens(loss_)) continue;
      queue(port, frame);
      if (happens(duplicate_)) queue(port, frame);
    }
  }

  void queue(std::size_t to, const Frame& frame) {
    if (waiting_.size() == kMaxWaiting) return;
    Clock::time_point due = Clock::now() + delay_;
    if (happens(reorder_)) due += kReordered;
    waiting_.push({due, number_++, to, frame});
  }

  void send_due() {
    while (!waiting_.empty() && waiting_.top().due <= Clock::now()) {
      const Waiting& next = waiting_.top();
      const Port& port = ports_[next.to];
      // A device that is full or down loses the frame.
      if (!port.cut) static_cast<void>(!::write(port.device, next.frame.data(), next.frame.size()));
      waiting_.pop();
    }
  }

  bool happens(double probability) {
    return probability > 0.0 &&
           std::uniform_real_distribution<double>(0.0, 1.0)(random_) < probability;
  }

  std::vector<Port> ports_;
  std::map<Address, std::size_t> known_;
  std::priority_queue<Waiting, std::vector<Waiting>, std::greater<>> waiting_;
  std::uint64_t number_ = 0;
  std::string orders_;
  double loss_ = 0.0;
  double reorder_ = 0.0;
  double duplicate_ = 0.0;
  std::chrono::milliseconds delay_{0};
  std::mt19937_64 random_{1};
};

}  // namespace

int main(int argc, char** argv) {
  try {
    FaultySwitch faulty_switch({argv + 1, argv + argc});
    std::cout << "ready" << std::endl;
    faulty_switch.run();
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "faulty_switch: " << error.what() << '\n';
    return 1;
  }
}
