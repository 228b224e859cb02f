#include "topogeo/scan/carmen_log_reader.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "carmen_line.hpp"
#include "gz_lines.hpp"

namespace topogeo::scan {
namespace {

bool has_binary_bytes(std::string_view line) {
  return std::any_of(line.begin(), line.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return (byte < 0x20U && byte != '\t') || byte == 0x7fU;
  });
}

// A scan read ahead, with the line it came from.
struct Candidate {
  Scan scan;
  std::uint64_t line = 0;
};

std::string seconds_text(std::int64_t stamp_ns) {
  const std::string nanoseconds = std::to_string(stamp_ns % 1'000'000'000);
  return std::to_string(stamp_ns / 1'000'000'000) + "." + std::string(9 - nanoseconds.size(), '0') +
         nanoseconds;
}

}  // namespace

std::string_view describe(SkipReason reason) {
  switch (reason) {
    case SkipReason::kFields:
      return "bad fields";
    case SkipReason::kRange:
      return "bad range";
    case SkipReason::kPose:
      return "bad odometry pose";
    case SkipReason::kStamp:
      return "bad time stamp";
    case SkipReason::kTime:
      return "time not increasing";
    case SkipReason::kGeometry:
      return "other beam geometry";
    case SkipReason::kText:
      return "not text";
    case SkipReason::kTruncated:
      return "compressed data cut off or damaged";
  }
  return "unknown";
}

std::uint64_t CarmenLogStatistics::skipped_total() const {
  return std::accumulate(skipped.begin(), skipped.end(), std::uint64_t{0});
}

std::string CarmenLogStatistics::summary() const {
  std::string text = std::to_string(scans) + " scans";
  const char* separator = ": ";
  if (skipped_total() == 0) return text;
  text += "; skipped " + std::to_string(skipped_total());
  for (std::size_t i = 0; i < kSkipReasonCount; ++i) {
    if (skipped[i] == 0) continue;
    text += separator + std::to_string(skipped[i]) + " " +
            std::string(describe(static_cast<SkipReason>(i)));
    separator = ", ";
  }
  return text;
}

struct CarmenLogReader::Impl {
  Impl(const std::filesystem::path& file, const CarmenLogOptions& options)
      : path(file.string()),
        lines(file),
        parser(options.range_max_m),
        jump_ns(static_cast<std::int64_t>(options.jump_s * 1e9)) {}

  void skip(SkipReason reason, std::uint64_t line, const std::string& text);
  std::optional<Candidate> next_readable();
  std::optional<Candidate> take();
  std::optional<Candidate> confirm(Candidate candidate);
  bool same_geometry(const Scan& scan) const;
  [[noreturn]] void throw_unusable() const;

  std::string path;
  GzLines lines;
  CarmenLineParser parser;
  std::int64_t jump_ns;
  CarmenLogStatistics statistics;
  bool damage_reported = false;
  std::optional<Scan> geometry;         // the first readable scan, which fixes the geometry
  std::optional<Candidate> read_ahead;  // comes before the rest of the file
  std::optional<std::int64_t> last_ns;  // stamp of the last scan that take() accepted
  std::optional<Candidate> ready;       // accepted, not yet handed out
  std::uint64_t sequence = 0;
  std::uint64_t odometry_epoch = 0;
};

void CarmenLogReader::Impl::skip(SkipReason reason, std::uint64_t line, const std::string& text) {
  ++statistics.skipped[static_cast<std::size_t>(reason)];
  if (statistics.messages.size() < CarmenLogStatistics::kMaxMessages) {
    statistics.messages.push_back(path + ":" + std::to_string(line) + ": " + text);
  }
}

bool CarmenLogReader::Impl::same_geometry(const Scan& scan) const {
  constexpr double kTolerance_rad = 1e-6;
  return scan.ranges_m.size() == geometry->ranges_m.size() &&
         std::fabs(scan.angle_min_rad - geometry->angle_min_rad) <= kTolerance_rad &&
         std::fabs(scan.angle_step_rad - geometry->angle_step_rad) <= kTolerance_rad;
}

// The next laser line that can be read by itself; its time is not checked.
std::optional<Candidate> CarmenLogReader::Impl::next_readable() {
  GzLines::Line line;
  while (lines.next(line)) {
    const std::uint64_t number = ++statistics.lines;
    if (line.too_long) {
      skip(SkipReason::kText, number,
           "expected a line of text, got more than 1 MiB without an end");
      continue;
    }
    const LineKind kind = line_kind(line.text);
    if (kind != LineKind::kLaser) {
      if (has_binary_bytes(line.text)) {
        skip(SkipReason::kText, number, "expected text, got binary bytes");
      } else {
        ++(kind == LineKind::kComment    ? statistics.comments
           : kind == LineKind::kOdometry ? statistics.odometry_lines
                                         : statistics.other_lines);
      }
      continue;
    }
    ++statistics.laser_lines;
    auto result = parser.parse(line.text);
    if (auto* error = std::get_if<LineError>(&result)) {
      skip(error->reason, number, error->text);
      continue;
    }
    Candidate candidate{std::get<Scan>(std::move(result)), number};
    if (!geometry) geometry = candidate.scan;
    if (!same_geometry(candidate.scan)) {
      skip(SkipReason::kGeometry, number,
           "expected " + std::to_string(geometry->ranges_m.size()) +
               " beams at the angles of the first scan, got " +
               std::to_string(candidate.scan.ranges_m.size()));
      continue;
    }
    // The angles of a log are rounded; one exact geometry spares comparisons.
    candidate.scan.angle_min_rad = geometry->angle_min_rad;
    candidate.scan.angle_step_rad = geometry->angle_step_rad;
    return candidate;
  }
  if (!lines.damage().empty() && !damage_reported) {
    damage_reported = true;
    skip(SkipReason::kTruncated, statistics.lines + 1,
         "expected more compressed data, got: " + lines.damage());
  }
  return std::nullopt;
}

// The next scan whose time is right.
std::optional<Candidate> CarmenLogReader::Impl::take() {
  while (true) {
    std::optional<Candidate> candidate = std::exchange(read_ahead, std::nullopt);
    if (!candidate) candidate = next_readable();
    if (!candidate) return std::nullopt;
    if (last_ns && candidate->scan.stamp_ns <= *last_ns) {
      skip(SkipReason::kTime, candidate->line,
           "expected a time stamp after " + seconds_text(*last_ns) + ", got " +
               seconds_text(candidate->scan.stamp_ns));
      continue;
    }
    if (!last_ns || candidate->scan.stamp_ns - *last_ns > jump_ns) {
      candidate = confirm(*std::move(candidate));
    }
    last_ns = candidate->scan.stamp_ns;
    return candidate;
  }
}

// A candidate far ahead of its predecessor: were it wrong and accepted, all that follows would look
// late and be lost. When the next scan is far earlier, yet still after the last accepted one, the
// candidate is the wrong one.
std::optional<Candidate> CarmenLogReader::Impl::confirm(Candidate candidate) {
  while (true) {
    std::optional<Candidate> following = next_readable();
    if (!following) return candidate;
    const std::int64_t following_ns = following->scan.stamp_ns;
    const bool earlier = candidate.scan.stamp_ns - following_ns > jump_ns;
    const bool usable = !last_ns || following_ns > *last_ns;
    if (!earlier || !usable) {
      read_ahead = std::move(following);
      return candidate;
    }
    skip(SkipReason::kTime, candidate.line,
         "expected a time stamp before that of the next scan, " + seconds_text(following_ns) +
             ", got " + seconds_text(candidate.scan.stamp_ns));
    candidate = *std::move(following);
  }
}

void CarmenLogReader::Impl::throw_unusable() const {
  const std::string expected = "expected a CARMEN log with FLASER or ROBOTLASER1 lines, got ";
  if (lines.bytes() == 0 && lines.damage().empty()) {
    throw std::runtime_error(path + ": " + expected + "an empty file");
  }
  if (statistics.laser_lines == 0) {
    const std::string damage = lines.damage().empty() ? "" : "; compressed data: " + lines.damage();
    if (statistics.skipped_for(SkipReason::kText) > 0) {
      throw std::runtime_error(path + ": " + expected + "binary data" + damage);
    }
    throw std::runtime_error(path + ": " + expected + std::to_string(statistics.lines) +
                             " lines without one" + damage);
  }
  throw std::runtime_error(path + ": none of " + std::to_string(statistics.laser_lines) +
                           " laser lines is usable; the first: " +
                           (statistics.messages.empty() ? "" : statistics.messages.front()));
}

CarmenLogReader::CarmenLogReader(const std::filesystem::path& path,
                                 const CarmenLogOptions& options) {
  check(options);
  impl_ = std::make_unique<Impl>(path, options);
  impl_->ready = impl_->take();
  if (!impl_->ready) impl_->throw_unusable();
}

CarmenLogReader::~CarmenLogReader() = default;
CarmenLogReader::CarmenLogReader(CarmenLogReader&&) noexcept = default;
CarmenLogReader& CarmenLogReader::operator=(CarmenLogReader&&) noexcept = default;

std::optional<Scan> CarmenLogReader::next() {
  std::optional<Candidate> candidate = std::exchange(impl_->ready, std::nullopt);
  if (!candidate) candidate = impl_->take();
  if (!candidate) return std::nullopt;
  if (impl_->sequence == 0) impl_->odometry_epoch = fingerprint(candidate->scan);
  candidate->scan.sequence = impl_->sequence++;
  candidate->scan.odometry_epoch = impl_->odometry_epoch;
  ++impl_->statistics.scans;
  return std::move(candidate->scan);
}

const CarmenLogStatistics& CarmenLogReader::statistics() const {
  return impl_->statistics;
}

double CarmenLogReader::fraction_read() const {
  return impl_->lines.fraction_read();
}

std::uint64_t count_scans(const std::filesystem::path& path) {
  GzLines lines(path);
  GzLines::Line line;
  std::uint64_t count = 0;
  while (lines.next(line)) {
    if (line_kind(line.text) == LineKind::kLaser) ++count;
  }
  return count;
}

}  // namespace topogeo::scan
