#include "log_gateway.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/messaging/message.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/support/log.hpp"

namespace topogeo::sensor_gateway {

using std::chrono::milliseconds;

namespace {

/// Scans in a row before signals and timers are served.
constexpr int kBatch = 16;
constexpr milliseconds kReplayPoll{20};
/// A replay that falls further behind shifts its schedule instead of rushing.
constexpr std::chrono::seconds kLargestDelay{1};

std::chrono::steady_clock::duration duration_of(double seconds) {
  return std::chrono::duration_cast<std::chrono::steady_clock::duration>(
      std::chrono::duration<double>(seconds));
}

/// Odometry at a scan, with the speed since the previous scan.
msg::Odometry odometry_of(const scan::Scan& scan, const std::string& robot_id,
                          const msg::Odometry& last) {
  msg::Odometry out;
  messaging::set_header(out, robot_id, scan.stamp_ns, scan.sequence);
  out.T_odom_robot(service::to_msg(scan.T_odom_robot));
  out.odometry_epoch(scan.odometry_epoch);
  if (scan.sequence > 0) {
    const double step_s = static_cast<double>(scan.stamp_ns - last.stamp_ns()) * 1e-9;
    const geometry::Pose2 step =
        geometry::between(service::from_msg(last.T_odom_robot()), scan.T_odom_robot);
    out.linear_mps(step.x_m / step_s);
    out.angular_radps(step.theta_rad / step_s);
  }
  return out;
}

}  // namespace

LogGateway::LogGateway(service::Service& service, const GatewayOptions& options,
                       service::LogFeed feed, std::uint64_t scans_total)
    : service_(service),
      options_(options),
      feed_(std::move(feed)),
      pace_(options.rate),
      scans_(service.advertise<msg::Scan>(messaging::kReplayRole)),
      odometry_(service.advertise<msg::Odometry>(messaging::kReplayRole)),
      stream_end_(service.advertise<msg::StreamEnd>()),
      readers_(
          service.loop(),
          {{"scans", options.readers.value_or(1), messaging::ConnectedPrograms(scans_, odometry_)},
           {"odometry", options.odometry_readers, messaging::ConnectedPrograms(odometry_)}}) {
  const auto& no_return = feed_.reader().no_return();
  if (no_return) spdlog::info("{}", text_of(*no_return));
  if (!feed_.why_laser().empty()) spdlog::info("odometry from the scans: {}", feed_.why_laser());
  service_.status().set_counter("scans_sent", 0.0);
  service_.status().set_counter("scans_total", static_cast<double>(scans_total));
  service_.subscribe<msg::ScanRequest>([this](const msg::ScanRequest& r) { on_request(r); });
  readers_.start([this](const std::string& what) { service_.status().wait_for(what); },
                 [this] { begin(); });
}

void LogGateway::begin() {
  service_.status().set_state(msg::kServiceRunning);
  start_ = Clock::now();
  replay();
}

void LogGateway::on_request(const msg::ScanRequest& request) {
  if (sent_ == 0) return;
  const bool of_this_log = request.odometry_epoch() == last_odometry_.odometry_epoch();
  const std::uint64_t wanted = of_this_log ? request.first_scan() : 0;
  if (wanted >= sent_ && !all_read_) return;  // the replay will reach it anyway
  try {
    go_back_to(std::min(wanted, sent_ - 1));
  } catch (const std::runtime_error& error) {
    service_.status().fault("log cannot be read again", error.what());
  }
}

void LogGateway::go_back_to(std::uint64_t number) {
  service::LogFeed feed = feed_.from_start();
  ReplayPace pace(options_.rate);
  msg::Odometry last;
  double after_s = 0.0;
  for (std::uint64_t i = 0; i < number; ++i) {
    const std::optional<scan::Scan> scan = feed.next();
    if (!scan) {
      throw std::runtime_error(options_.log.string() + ": fewer scans than at the first reading");
    }
    after_s = pace.next(scan->stamp_ns).after_s;
    last = odometry_of(*scan, service_.robot_id(), last);
  }
  spdlog::info("resending the scans from number {}", number);
  feed_ = std::move(feed);
  pace_ = pace;
  last_odometry_ = last;
  start_ = Clock::now() - duration_of(after_s);
  pending_scan_.reset();
  pending_odometry_.reset();
  sent_ = number;
  all_read_ = end_sent_ = false;
  service_.status().set_state(msg::kServiceRunning);
  service_.loop().cancel_timer(timer_);  // it may belong to a scan after a long gap
  go_on_after({});
}

void LogGateway::go_on_after(Clock::duration delay) {
  timer_ = service_.loop().call_after(delay, [this] { all_read_ ? finish() : replay(); });
}

void LogGateway::replay() {
  for (int i = 0; i < kBatch; ++i) {
    if (!pending_scan_ && !pending_odometry_ && !read_next()) {
      all_read_ = true;
      finish();
      return;
    }
    const auto now = Clock::now();
    if (now < due_) {
      go_on_after(due_ - now);
      return;
    }
    if (!send_pending()) break;  // a reader is slow
  }
  go_on_after({});
}

bool LogGateway::read_next() {
  const std::optional<scan::Scan> scan = feed_.next();
  count();
  if (!scan) return false;
  const ReplayPace::Due due = pace_.next(scan->stamp_ns);
  if (due.shortened_gap_s > 0.0) {
    spdlog::info("scan {}: a gap of {:.0f} s in the log is replayed as {:.0f} s", scan->sequence,
                 due.shortened_gap_s, ReplayPace::kShortened_s);
  }
  due_ = start_ + duration_of(due.after_s);
  if (options_.rate && Clock::now() - due_ > kLargestDelay) {
    service_.status().add_to_counter("delayed_s");
    start_ += kLargestDelay;
  }
  pending_scan_ = service::to_msg(*scan, service_.robot_id());
  pending_odometry_ = odometry_of(*scan, service_.robot_id(), last_odometry_);
  if (sent_ == 0) {
    service_.status().set_counter("beams", static_cast<double>(scan->ranges_m.size()));
  }
  return true;
}

bool LogGateway::send_pending() {
  if (pending_scan_) {
    if (!scans_.write(*pending_scan_)) return false;
    pending_scan_.reset();
    ++sent_;
    service_.status().count_input("scan");
  }
  if (!odometry_.write(*pending_odometry_)) return false;
  last_odometry_ = *std::exchange(pending_odometry_, std::nullopt);
  return true;
}

void LogGateway::count() {
  messaging::StatusPublisher& status = service_.status();
  status.set_counter("scans_sent", static_cast<double>(sent_));
  const scan::CarmenLogStatistics& log = feed_.reader().statistics();
  for (std::size_t i = 0; i < scan::kSkipReasonCount; ++i) {
    const auto reason = static_cast<scan::SkipReason>(i);
    status.set_drops(scan::describe(reason), log.skipped[i]);
  }
}

void LogGateway::finish() {
  if (!scans_.wait_for_acknowledgments(kReplayPoll) ||
      !odometry_.wait_for_acknowledgments(kReplayPoll) ||
      (end_sent_ && !stream_end_.wait_for_acknowledgments(kReplayPoll))) {
    go_on_after({});
    return;
  }
  if (!end_sent_) {
    msg::StreamEnd end;
    messaging::set_header(end, service_.robot_id(), last_odometry_.stamp_ns(), ends_sent_);
    end.stage(msg::kStageGateway);
    end.count(sent_);
    end.last_id(sent_ == 0 ? 0 : sent_ - 1);
    if (!service_.send(stream_end_, end, "stream end")) return;
    end_sent_ = true;
    ++ends_sent_;
    go_on_after({});
    return;
  }
  const scan::CarmenLogStatistics& log = feed_.reader().statistics();
  for (const std::string& note : log.notes) spdlog::warn("{}", note);
  for (const std::string& message : log.messages) spdlog::warn("skipped {}", message);
  spdlog::info("{}", log.summary());
  if (const localization::LaserOdometryCounts* counts = feed_.laser_counts()) {
    spdlog::info("{} scans match no others, the track was lost {} times", counts->unplaced,
                 counts->breaks);
    if (counts->unseen > 0) {
      spdlog::info("{} scans are left out between bare walls", counts->unseen);
    }
    const std::string sparse = pipeline::too_sparse(*counts);
    if (!sparse.empty()) service_.status().fault("scans too sparse", sparse);
  }
  service_.status().set_state(msg::kServiceFinished, log.summary());
  if (options_.exit_at_end) service_.loop().stop();
}

}  // namespace topogeo::sensor_gateway
