#include "topogeo/scan/carmen_log_reader.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "topogeo/scan/scan_sequence.hpp"
#include "topogeo/support/printable.hpp"

#include "carmen_line.hpp"
#include "gz_lines.hpp"
#include "screened_scans.hpp"

namespace topogeo::scan {
namespace {

bool has_binary_bytes(std::string_view line) {
  return std::any_of(line.begin(), line.end(),
                     [](char c) { return support::is_control(c) && c != '\t'; });
}

/// Whether a text begins with the mark of UTF-16, as a redirection of PowerShell writes it.
bool is_utf16(const std::filesystem::path& path) {
  GzLines lines(path);
  GzLines::Line line;
  return lines.next(line) &&
         (line.text.starts_with("\xFF\xFE") || line.text.starts_with("\xFE\xFF"));
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
    case SkipReason::kNoOdometry:
      return "no odometry at its time";
    case SkipReason::kOdometryEnds:
      return "before or after all odometry";
    case SkipReason::kRepeated:
      return "repeated readings of a laser that hangs";
  }
  return "unknown";
}

void CarmenLogStatistics::skip(SkipReason reason, std::string message) {
  if (skipped[static_cast<std::size_t>(reason)]++ == 0) messages.push_back(std::move(message));
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
        odometry([this] { return next_readable(); },
                 [this](SkipReason reason, std::uint64_t line, const std::string& text) {
                   skip(reason, line, text);
                 }),
        sequence(
            options.jump_s, [this] { return odometry.next(); },
            [this](SkipReason reason, std::uint64_t line, const std::string& text) {
              skip(reason, line, text);
            }) {}

  void skip(SkipReason reason, std::uint64_t line, const std::string& text);
  std::optional<ScanSequence::Candidate> next_readable();
  void note_first_word(std::string_view line);
  [[noreturn]] void throw_unusable() const;

  std::string path;
  GzLines lines;
  CarmenLineParser parser;
  ScreenedScans odometry;
  ScanSequence sequence;
  CarmenLogStatistics statistics;
  bool damage_reported = false;
  std::vector<std::string> first_words;  // of the first lines that have no scan
  std::optional<Scan> ready;             // accepted, not yet returned
};

void CarmenLogReader::Impl::skip(SkipReason reason, std::uint64_t line, const std::string& text) {
  statistics.skip(reason, path + ":" + std::to_string(line) + ": " + text);
}

void CarmenLogReader::Impl::note_first_word(std::string_view line) {
  constexpr std::size_t kMostWords = 2;
  constexpr std::size_t kMostBytes = 24;
  if (first_words.size() == kMostWords || statistics.laser_lines > 0) return;
  const std::size_t begin = line.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return;
  const std::size_t end = std::min(line.find_first_of(" \t\r", begin), begin + kMostBytes);
  std::string word = support::printable(line.substr(begin, end - begin));
  if (std::ranges::find(first_words, word) == first_words.end()) {
    first_words.push_back(std::move(word));
  }
}

// The next individually readable laser line, without a check of its time.
std::optional<ScanSequence::Candidate> CarmenLogReader::Impl::next_readable() {
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
        if (kind != LineKind::kComment) note_first_word(line.text);
      }
      continue;
    }
    ++statistics.laser_lines;
    auto result = parser.parse(line.text);
    if (auto* error = std::get_if<LineError>(&result)) {
      skip(error->reason, number, error->text);
      continue;
    }
    return ScanSequence::Candidate{std::get<Scan>(std::move(result)), number};
  }
  if (!lines.damage().empty() && !damage_reported) {
    damage_reported = true;
    skip(SkipReason::kTruncated, statistics.lines + 1,
         "expected more compressed data, got: " + lines.damage());
  }
  return std::nullopt;
}

void CarmenLogReader::Impl::throw_unusable() const {
  const std::string expected = "expected a CARMEN log with FLASER or ROBOTLASER1 lines, got ";
  if (lines.bytes() == 0 && lines.damage().empty()) {
    throw std::runtime_error(path + ": " + expected + "an empty file");
  }
  if (statistics.laser_lines == 0) {
    if (is_utf16(path)) {
      throw std::runtime_error(path + ": " + expected +
                               "text in UTF-16; convert it with `iconv -f " + "UTF-16 -t UTF-8 " +
                               path + " > utf8.clf` and give utf8.clf");
    }
    const std::string damage = lines.damage().empty() ? "" : "; compressed data: " + lines.damage();
    const std::string others = "; recordings of ROS (.bag, .db3, .mcap) are read, too";
    if (statistics.skipped_for(SkipReason::kText) > 0) {
      throw std::runtime_error(path + ": " + expected + "binary data" + damage + others);
    }
    std::string words;
    for (const std::string& word : first_words) {
      words += (words.empty() ? "; they begin with '" : ", '") + word + "'";
    }
    throw std::runtime_error(path + ": " + expected + std::to_string(statistics.lines) +
                             " lines without one" + words + damage + others);
  }
  throw std::runtime_error(path + ": none of " + std::to_string(statistics.laser_lines) +
                           " laser lines is usable; the first: " +
                           (statistics.messages.empty() ? "" : statistics.messages.front()));
}

CarmenLogReader::CarmenLogReader(const std::filesystem::path& path,
                                 const CarmenLogOptions& options) {
  check(options);
  impl_ = std::make_unique<Impl>(path, options);
  impl_->ready = impl_->sequence.next();
  if (!impl_->ready) impl_->throw_unusable();
}

CarmenLogReader::~CarmenLogReader() = default;
CarmenLogReader::CarmenLogReader(CarmenLogReader&&) noexcept = default;
CarmenLogReader& CarmenLogReader::operator=(CarmenLogReader&&) noexcept = default;

std::optional<Scan> CarmenLogReader::next() {
  std::optional<Scan> scan = std::exchange(impl_->ready, std::nullopt);
  if (!scan) scan = impl_->sequence.next();
  if (scan) ++impl_->statistics.scans;
  impl_->statistics.notes = impl_->odometry.notes();
  return scan;
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
