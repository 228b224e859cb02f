#include "topogeo/devices/pls_search.hpp"

#include <algorithm>

#include "topogeo/devices/line_time.hpp"
#include "topogeo/devices/pls_messages.hpp"

namespace topogeo::devices {
namespace {

/// This much garbage, more than a stray byte, shows a sender at another rate.
constexpr std::uint64_t kGarbage = 8;
/// Most doublings of a pause, so that it fits its type; the settings limit it long before.
constexpr int kMostDoublings = 20;

void add_once(std::vector<LineSettings>& lines, const LineSettings& line) {
  if (std::ranges::find(lines, line) == lines.end()) lines.push_back(line);
}

}  // namespace

std::string line_name(const LineSettings& line) {
  const char* const parity = line.parity == Parity::kNone   ? "no"
                             : line.parity == Parity::kEven ? "even"
                                                            : "odd";
  return std::to_string(line.baud) + " baud, " + parity + " parity";
}

void PlsSearch::start(bool listen_first, std::int64_t now_ns) {
  const bool listen = (listen_first || line_.expected()) && line_.known();
  candidates_ = planned();
  if (listen) candidates_.insert(candidates_.begin(), *line_.known());
  candidate_ = 0;
  try_line(candidates_.front(), listen, now_ns);
}

/// A sensor that was heard before is most likely still there, or at the power-on rate if it
/// restarted; it announces that only once, so that rate is tried between all others. The other
/// parity, another kind of sensor, is tried after the first search has failed.
std::vector<LineSettings> PlsSearch::planned() const {
  std::vector<LineSettings> all;
  for (const Parity parity : settings_.parities) {
    for (const std::uint32_t baud : settings_.detection_bauds) add_once(all, {baud, parity});
    add_once(all, {settings_.power_on_baud, parity});
    add_once(all, {settings_.baud, parity});
  }
  if (!line_.known()) return all;
  const LineSettings known = *line_.known();
  const LineSettings power_on = line_.power_on();
  std::vector<LineSettings> lines{known, power_on, known, power_on};
  for (const LineSettings& line : all) {
    if (line == known || line == power_on) continue;
    if (line.parity != known.parity && failures_ == 0) continue;
    lines.push_back(line);
    lines.push_back(power_on);
  }
  return lines;
}

/// Listens with these settings and, unless the stream itself is expected, asks the sensor to stop
/// its stream, which it answers in any state.
void PlsSearch::try_line(const LineSettings& line, bool listen_only, std::int64_t now_ns) {
  line_.set(line);
  line_.listen(now_ns);
  listen_only_ = listen_only;
  since_ns_ = now_ns;
  if (!listen_only) line_.write(pls_mode_command(PlsMode::kOnRequest));
}

bool PlsSearch::tick(std::int64_t now_ns) {
  if (now_ns < due_ns()) return true;
  if (line_.expected()) {
    line_.doubt();
    start(false, now_ns);
    return true;
  }
  if (++candidate_ < candidates_.size()) {
    try_line(candidates_[candidate_], false, now_ns);
    return true;
  }
  ++failures_;
  return false;
}

std::int64_t PlsSearch::due_ns() const {
  const std::int64_t asked_ns =
      since_ns_ + line_time_ns(pls_mode_command(PlsMode::kOnRequest).size(), line_.settings());
  const std::int64_t quiet_ns =
      std::max(asked_ns, line_.last_byte_ns()) + settings_.detection_quiet_ns;
  // A streaming sensor has sent a whole scan by then, and has answered.
  const std::int64_t whole_ns = asked_ns + 2 * line_.scan_time_ns() + settings_.detection_quiet_ns;
  return std::min(quiet_ns, whole_ns);
}

bool PlsSearch::hears_garbage() const {
  return line_.garbage() >= kGarbage;
}

void PlsSearch::follow_garbage(std::int64_t now_ns) {
  const auto& known = line_.known();
  if (known && line_.settings() != *known) try_line(LineSettings{*known}, true, now_ns);
}

void PlsSearch::rest(int failures, std::int64_t now_ns) {
  line_.set(line_.power_on());
  const int doublings = std::clamp(failures - 1, 0, kMostDoublings);
  rested_ns_ = now_ns + std::min(settings_.longest_pause_ns, settings_.first_pause_ns << doublings);
}

}  // namespace topogeo::devices
