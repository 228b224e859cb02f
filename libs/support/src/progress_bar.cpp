#include "topogeo/support/progress_bar.hpp"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <utility>

#include <unistd.h>

#include "topogeo/support/format.hpp"

namespace topogeo::support {
namespace {

constexpr std::uint64_t kCells = 24;       // leaves room for the texts in 80 columns
constexpr double kRedrawInterval_s = 0.1;  // smooth at negligible cost

/// "42 s", "3 min 05 s" or "2 h 07 min".
std::string duration_text(double duration_s) {
  // The cap keeps the conversion defined if a stalled job's remaining time is huge.
  const auto s = static_cast<std::uint64_t>(std::clamp(std::ceil(duration_s), 0.0, 3.6e8));
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{} min {:02} s", s / 60, s % 60);
  return fmt::format("{} h {:02} min", s / 3600, s / 60 % 60);
}

}  // namespace

bool stderr_is_terminal() {
  return ::isatty(STDERR_FILENO) == 1;
}

ProgressBar::ProgressBar(std::ostream& out, bool is_terminal, std::string label, std::string unit)
    : out_(out), is_terminal_(is_terminal), label_(std::move(label)), unit_(std::move(unit)) {}

std::string ProgressBar::line(std::uint64_t done, std::uint64_t total, double elapsed_s) const {
  const double rate = elapsed_s > 0.0 ? static_cast<double>(done) / elapsed_s : 0.0;
  const std::string rate_text =
      rate >= 100.0 ? fmt::format("{:.0f}", rate) : fmt::format("{:.1f}", rate);
  if (total == 0) {
    return fmt::format("{} {} {}, {} per s", label_, done, unit_, rate_text);
  }
  const std::uint64_t shown = std::min(done, total);
  const double fraction = static_cast<double>(shown) / static_cast<double>(total);
  const auto filled =
      static_cast<std::size_t>(std::floor(fraction * static_cast<double>(kCells) + 1e-9));
  const std::string bar = std::string(filled, '#') + std::string(kCells - filled, '.');
  std::string left = "time left unknown";
  if (shown == total) {
    left = "took " + duration_text(elapsed_s);
  } else if (rate > 0.0) {
    left = duration_text(static_cast<double>(total - shown) / rate) + " left";
  }
  return fmt::format("{} [{}] {:3.0f} % {}/{} {}, {} per s, {}", label_, bar,
                     std::floor(100.0 * fraction + 1e-9), done, total, unit_, rate_text, left);
}

void ProgressBar::draw(const std::string& text) {
  // Blanks overwrite the rest of a longer previous line.
  const std::size_t blanks = drawn_length_ > text.size() ? drawn_length_ - text.size() : 0;
  out_ << '\r' << text << std::string(blanks, ' ') << std::flush;
  drawn_length_ = text.size();
}

void ProgressBar::update(std::uint64_t done, std::uint64_t total, double elapsed_s) {
  if (is_terminal_) {
    if (elapsed_s < next_draw_s_) return;
    next_draw_s_ = elapsed_s + kRedrawInterval_s;
    draw(line(done, total, elapsed_s));
    return;
  }
  if (total == 0) return;
  const std::uint64_t tenths = std::min(done, total) * 10 / total;
  if (tenths <= tenths_printed_ || tenths >= 10) return;  // finish() draws the last line
  tenths_printed_ = tenths;
  out_ << line(done, total, elapsed_s) << std::endl;
}

void ProgressBar::finish(std::uint64_t done, std::uint64_t total, double elapsed_s) {
  if (is_terminal_) {
    draw(line(done, total, elapsed_s));
    out_ << std::endl;
  } else {
    out_ << line(done, total, elapsed_s) << std::endl;
  }
}

}  // namespace topogeo::support
