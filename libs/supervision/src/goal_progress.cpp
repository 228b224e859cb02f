#include "topogeo/supervision/goal_progress.hpp"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <string_view>

#include <sys/ioctl.h>
#include <unistd.h>

#include "topogeo/support/format.hpp"

namespace topogeo::supervision {
namespace {

using navigation::NavigatorState;
using navigation::NavigatorStatus;

constexpr std::size_t kCells = 24;       // of the bar; leaves room for the numbers in 80 columns
constexpr double kRedraw_s = 0.1;        // faster changes cannot be read
constexpr double kPlainPeriod_s = 10.0;  // keeps the file of a long drive short

std::string bar(double share) {
  const auto filled =
      static_cast<std::size_t>(std::floor(share * static_cast<double>(kCells) + 1e-9));
  return std::string(filled, '#') + std::string(kCells - filled, '.');
}

bool same(const NavigatorStatus& a, const NavigatorStatus& b) {
  return a.state == b.state && a.reason == b.reason;
}

}  // namespace

std::string progress_line(const NavigatorStatus& status) {
  const double whole_m = status.driven_m + status.rest_m;
  if (status.state == NavigatorState::kArrived) {
    return fmt::format("arrived after {:.1f} m", status.driven_m);
  }
  if (status.state != NavigatorState::kDriving) {
    std::string text(navigation::describe(status.state));
    if (!status.message.empty()) text += ": " + status.message;
    return text;
  }
  const double share = whole_m > 0.0 ? std::clamp(status.driven_m / whole_m, 0.0, 1.0) : 0.0;
  return fmt::format("driving [{}] {:3.0f} %, {:.1f} m to go, about {:.0f} s", bar(share),
                     std::floor(100.0 * share), status.rest_m, std::ceil(status.rest_s));
}

void GoalProgress::show(const NavigatorStatus& status, double now_s) {
  const bool changed = !last_ || !same(status, *last_);
  last_ = status;
  const std::string text = progress_line(status);
  if (!is_terminal_) {
    if (!changed && now_s < due_s_) return;
    due_s_ = now_s + kPlainPeriod_s;
    out_ << text << std::endl;
    return;
  }
  if (changed && status.state != NavigatorState::kDriving) {
    print(text);
    return;
  }
  if (!changed && now_s < due_s_) return;
  due_s_ = now_s + kRedraw_s;
  draw(text);
}

void GoalProgress::print(const std::string& text) {
  if (is_terminal_ && drawn_ > 0) {
    out_ << '\r' << std::string(drawn_, ' ') << '\r';
    drawn_ = 0;
  }
  out_ << text << std::endl;
}

void GoalProgress::finish() {
  if (is_terminal_ && drawn_ > 0) out_ << std::endl;
  drawn_ = 0;
}

void GoalProgress::draw(const std::string& text) {
  const std::string line = text.substr(0, columns_ > 1 ? columns_ - 1 : 1);
  const std::size_t blanks = drawn_ > line.size() ? drawn_ - line.size() : 0;
  out_ << '\r' << line << std::string(blanks, ' ') << std::flush;
  drawn_ = line.size();
}

std::size_t terminal_columns() {
  winsize size{};
  constexpr std::size_t kUsual = 80;
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-vararg): the system's interface
  if (::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return kUsual;
  return size.ws_col;
}

}  // namespace topogeo::supervision
