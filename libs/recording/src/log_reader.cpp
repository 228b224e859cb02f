#include "topogeo/recording/log_reader.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "topogeo/recording/message_source.hpp"
#include "topogeo/scan/laser_mounting.hpp"
#include "topogeo/scan/scan_check.hpp"

#include "no_return_search.hpp"
#include "ros_scans.hpp"

namespace topogeo::recording {

struct LogReader::Source {
  Source() = default;
  virtual ~Source() = default;
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;

  virtual std::optional<scan::Scan> next() = 0;
  [[nodiscard]] virtual const scan::CarmenLogStatistics& statistics() const = 0;
  [[nodiscard]] virtual double fraction_read() const = 0;
  [[nodiscard]] virtual bool has_odometry() const { return true; }
};

namespace {

/// The scan of a laser upside down, seen from above.
void mirror(scan::Scan& scan) {
  if (scan.ranges_m.empty()) return;
  const auto steps = static_cast<double>(scan.ranges_m.size() - 1);
  scan.angle_min_rad = -(scan.angle_min_rad + scan.angle_step_rad * steps);
  std::ranges::reverse(scan.ranges_m);
}

std::int64_t delay_ns(const TopicChoice& choice) {
  return std::llround(1e9 * choice.scan_delay_s.value_or(0.0));
}

class CarmenScans final : public LogReader::Source {
 public:
  CarmenScans(const std::filesystem::path& path, const scan::CarmenLogOptions& options,
              bool upside_down)
      : reader_(path, options),
        range_scale_(static_cast<float>(options.range_scale)),
        upside_down_(upside_down) {}
  std::optional<scan::Scan> next() override {
    std::optional<scan::Scan> scan = reader_.next();
    if (!scan) return scan;
    for (float& range_m : scan->ranges_m) range_m *= range_scale_;
    if (upside_down_) mirror(*scan);
    return scan;
  }
  [[nodiscard]] const scan::CarmenLogStatistics& statistics() const override {
    return reader_.statistics();
  }
  [[nodiscard]] double fraction_read() const override { return reader_.fraction_read(); }

 private:
  scan::CarmenLogReader reader_;
  float range_scale_;
  bool upside_down_;
};

class RecordedScans final : public LogReader::Source {
 public:
  RecordedScans(const std::filesystem::path& path, const scan::CarmenLogOptions& options,
                std::shared_ptr<const Drive> drive, const TopicChoice& choice)
      : name_(path.string()),
        scans_(path, std::move(drive), choice.sweep,
               {options.range_max_m, options.range_scale, delay_ns(choice)},
               RosScans::Beams::kOnePattern, skip()),
        sequence_(
            options.jump_s, [this] { return scans_.next(); }, skip()) {
    ready_ = sequence_.next();
    if (ready_) return;
    throw std::runtime_error(
        name_ + ": none of " + std::to_string(scans_.scan_messages()) + " scans of " +
        scans_.facts().scan_topic + " is usable" +
        (statistics_.messages.empty() ? "" : "; the first: " + statistics_.messages.front()));
  }

  std::optional<scan::Scan> next() override {
    std::optional<scan::Scan> scan = std::exchange(ready_, std::nullopt);
    if (!scan) scan = sequence_.next();
    if (scan) ++statistics_.scans;
    statistics_.lines = scans_.messages();
    statistics_.laser_lines = scans_.scan_messages();
    statistics_.odometry_lines = scans_.odometry_messages();
    statistics_.notes = scans_.notes();
    return scan;
  }
  [[nodiscard]] const scan::CarmenLogStatistics& statistics() const override { return statistics_; }
  [[nodiscard]] double fraction_read() const override { return scans_.fraction_read(); }
  [[nodiscard]] bool has_odometry() const override {
    return !scans_.facts().odometry_topic.empty();
  }

 private:
  scan::ScanSequence::Skip skip() {
    return [this](scan::SkipReason reason, std::uint64_t scan, const std::string& text) {
      // Messages of odometry belong to no scan.
      const std::string place = scan == 0 ? "" : "scan " + std::to_string(scan) + ": ";
      statistics_.skip(reason,
                       reason == scan::SkipReason::kTruncated ? text : name_ + ": " + place + text);
    };
  }

  std::string name_;
  scan::CarmenLogStatistics statistics_;
  RosScans scans_;
  scan::ScanSequence sequence_;
  std::optional<scan::Scan> ready_;
};

}  // namespace

/// All that is known of a log before its scans are read.
struct LogReader::Opened {
  Opened(const std::filesystem::path& log, const scan::CarmenLogOptions& wanted,
         const TopicChoice& choice)
      : path(log), options(wanted), topics(choice) {
    check(options);
    if (is_recording(path)) open_drive();
    no_return = find_no_return(path, options, drive);
    if (no_return) options.range_max_m = std::min(options.range_max_m, no_return->least_m);
  }

  /// Odometry without a usable pose counts as none, where none is allowed.
  void open_drive() {
    drive = std::make_shared<const Drive>(path, topics);
    const Timeline& timeline = drive->timeline;
    if (topics.odometry_use != OdometryUse::kIfRecorded || timeline.fault_count() == 0 ||
        !timeline.odometry().empty()) {
      return;
    }
    odometry_fault = timeline.faults().front();
    TopicChoice without = topics;
    without.odometry_use = OdometryUse::kIgnored;
    drive = std::make_shared<const Drive>(path, without);
  }

  [[nodiscard]] std::unique_ptr<Source> source() const {
    if (drive) return std::make_unique<RecordedScans>(path, options, drive, topics);
    return std::make_unique<CarmenScans>(path, options, topics.upside_down);
  }

  std::filesystem::path path;
  scan::CarmenLogOptions options;
  TopicChoice topics;
  std::shared_ptr<const Drive> drive{};  // of a recording
  std::string odometry_fault{};
  std::optional<scan::NoReturn> no_return{};
};

LogReader::LogReader(const std::filesystem::path& path, const scan::CarmenLogOptions& options,
                     const TopicChoice& topics)
    : LogReader(std::make_shared<const Opened>(path, options, topics)) {}

LogReader::LogReader(std::shared_ptr<const Opened> opened)
    : opened_(std::move(opened)), source_(opened_->source()) {}

LogReader LogReader::from_start() const {
  return LogReader(opened_);
}

LogReader::~LogReader() = default;
LogReader::LogReader(LogReader&&) noexcept = default;
LogReader& LogReader::operator=(LogReader&&) noexcept = default;

std::optional<scan::Scan> LogReader::next() {
  return source_->next();
}

const scan::CarmenLogStatistics& LogReader::statistics() const {
  return source_->statistics();
}

double LogReader::fraction_read() const {
  return source_->fraction_read();
}

bool LogReader::has_odometry() const {
  return source_->has_odometry();
}

std::optional<LogReader::OdometryPose> LogReader::odometry_at(std::int64_t stamp_ns) const {
  if (!opened_->drive || opened_->drive->survey.odometry_topic.empty()) return std::nullopt;
  const auto found = opened_->drive->timeline.odometry().at(stamp_ns);
  if (!found) return std::nullopt;
  return OdometryPose{found->T_odom_robot, found->epoch};
}

const std::string& LogReader::odometry_fault() const {
  return opened_->odometry_fault;
}

std::uint64_t LogReader::scan_count() const {
  return opened_->drive ? opened_->drive->survey.scans : scan::count_scans(opened_->path);
}

const std::optional<scan::NoReturn>& LogReader::no_return() const {
  return opened_->no_return;
}

LogMounting mounting_in_log(const std::filesystem::path& path, const TopicChoice& topics) {
  if (!is_recording(path)) {
    const std::optional<geometry::Pose2> stated = scan::mounting_in_log(path);
    return {stated ? stated : topics.T_robot_laser, {}};
  }
  Survey facts = survey(path, topics);
  LogMounting mounting;
  if (facts.mounting) mounting.T_robot_laser = facts.mounting->T_robot_laser;
  mounting.notes = std::move(facts.notes);
  return mounting;
}

scan::LogCheck check_log(const std::filesystem::path& path, const scan::LogCheckOptions& options,
                         const TopicChoice& topics) {
  if (!is_recording(path)) return scan::check_carmen_log(path, options);
  constexpr double kNoLimit_m = 1e9;
  scan::ScanCheck check(options);
  RosScans scans(path, std::make_shared<const Drive>(path, topics), ros::SweepOrder::kNone,
                 {kNoLimit_m, 1.0, delay_ns(topics)}, RosScans::Beams::kAsMeasured,
                 [&](scan::SkipReason reason, std::uint64_t scan, const std::string& text) {
                   // Drivers start and end one after the other.
                   if (reason == scan::SkipReason::kOdometryEnds) return;
                   check.found(scan::fault_of(reason), scan, text);
                 });
  while (std::optional<scan::ScanSequence::Candidate> candidate = scans.next()) {
    check.take(candidate->place, std::move(candidate->scan));
  }
  scan::LogCheck result = check.finish();
  result.lines = scans.messages();
  result.laser_lines = scans.scan_messages();
  result.odometry_lines = scans.odometry_messages();
  return result;
}

}  // namespace topogeo::recording
