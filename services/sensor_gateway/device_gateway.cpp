#include "device_gateway.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "topogeo/messaging/message.hpp"
#include "topogeo/pipeline/scan_feed.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/service/navigation_conversions.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/host.hpp"
#include "topogeo/support/log.hpp"
#include "topogeo/support/random.hpp"

namespace topogeo::sensor_gateway {

using std::chrono::milliseconds;

namespace {

constexpr milliseconds kStatePeriod{250};    // twice per status, so that it is up to date
constexpr milliseconds kBodyPeriod{100};     // period of a ring of sonars that fire in turns
constexpr milliseconds kLastDelivery{2000};  // time for readers to receive published data
constexpr milliseconds kDeliveryPoll{10};

ScanGateOptions gate_options(const service::Service& service, const DeviceConfig& config,
                             std::uint64_t odometry_epoch) {
  ScanGateOptions options;
  options.odometry_epoch = odometry_epoch;
  options.has_base = !config.base_port.empty();
  options.odometry_wait_ns = config.odometry_wait_ns;
  options.longest_extrapolation_ns = config.longest_extrapolation_ns;
  options.T_robot_laser = service.setup().config.config.local_mapper.T_robot_laser;
  options.range_max_m = service.setup().config.config.log.range_max_m;
  return options;
}

/// Empty like `memory`.
std::filesystem::path beside(const std::filesystem::path& memory, const char* ending) {
  return memory.empty() ? memory : std::filesystem::path(memory.string() + ending);
}

}  // namespace

DeviceGateway::DeviceGateway(service::Service& service, const DeviceConfig& config, int readers,
                             const std::filesystem::path& memory)
    : service_(service),
      memory_(memory),
      odometry_epoch_(support::unrepeatable_u64()),
      gate_(gate_options(service, config, odometry_epoch_)),
      scans_(service.advertise<msg::Scan>()),
      stream_end_(service.advertise<msg::StreamEnd>()) {
  service_.status().set_counter("scans_sent", 0.0);
  if (config.base_port.empty()) {
    begin_without_base();
  } else {
    const std::optional<RememberedOdometry> remembered = memory_.load();
    BaseChannel::Hooks hooks;
    hooks.on_epoch = [this, remembered](std::uint64_t epoch, bool resumed) {
      odometry_epoch_ = epoch;
      gate_.begin(epoch, resumed ? remembered->next_sequence : 0);
    };
    hooks.on_odometry = [this](const geometry::OdometrySample& sample) {
      gate_.add(sample);
      release(support::monotonic_ns());
      remember();
    };
    base_.emplace(service_, config, time_, remembered, beside(memory, ".stops"), std::move(hooks));
    compare_watchdog(config.base.watchdog_s);
  }
  if (!config.laser_port.empty()) {
    laser_.emplace(
        service_, config, time_, gate_, beside(memory, ".laser"),
        [this](const devices::LaserScan& scan) { show_base(scan); },
        [this](std::int64_t arrival_ns) { release(arrival_ns); });
  }
  begin_body(config.body_sensors);
  timer_ = service_.loop().add_timer(kStatePeriod, [this] { publish_state(); });
  publish_state();
  messaging::ConnectedPrograms connected(scans_);
  if (base_) connected.include(base_->odometry());
  reader_wait_.emplace(service_.loop(),
                       std::vector<ReaderWait::Wanted>{{"scans", readers, connected}});
  reader_wait_->start([](const std::string& what) { spdlog::info("waiting for {}", what); },
                      [this] { gate_.open(); });
}

void DeviceGateway::begin_body(BodySensorKind kind) {
  if (kind == BodySensorKind::kNone) return;
  if (kind == BodySensorKind::kBase) {
    body_.emplace(service_, *base_->sonars(), base_->sonar_mounts());
  } else {
    body_sensors_ = std::make_unique<devices::MspBodySensors>();
    body_.emplace(service_, *body_sensors_, devices::b21_sonar_ring().mounts);
  }
  body_timer_ = service_.loop().add_timer(kBodyPeriod, [this] { read_body(); });
}

DeviceGateway::~DeviceGateway() {
  service_.loop().cancel_timer(timer_);
  if (body_) service_.loop().cancel_timer(body_timer_);
  service_.loop().cancel_timer(release_timer_);
}

void DeviceGateway::show_base(const devices::LaserScan& scan) {
  if (!base_) return;
  scan::Scan seen;
  seen.stamp_ns = scan.stamp_ns;
  seen.angle_min_rad = scan.angle_min_rad;
  seen.angle_step_rad = scan.angle_step_rad;
  seen.ranges_m = scan.ranges_m;
  base_->see(
      service::to_scan_points(seen, service_.setup().config.config.local_mapper.T_robot_laser));
}

void DeviceGateway::release(std::int64_t now_ns) {
  if (ended_) return;  // the end of the stream gives the number of scans
  for (ScanGate::Leaving& leaving : gate_.take(now_ns)) {
    for (const scan::Scan& scan : placed(std::move(leaving.scan))) {
      if (!publish(scan)) continue;
      wait_ns_ = now_ns - leaving.arrival_ns;
      latency_ns_ = support::monotonic_ns() - leaving.arrival_ns;
      largest_latency_ns_ = std::max(largest_latency_ns_, latency_ns_);
      remember();
    }
  }
  service_.loop().cancel_timer(release_timer_);
  if (gate_.due_ns() == std::numeric_limits<std::int64_t>::max()) return;
  release_timer_ = service_.loop().call_after(
      std::chrono::nanoseconds(std::max<std::int64_t>(0, gate_.due_ns() - now_ns)),
      [this] { release(support::monotonic_ns()); });
}

void DeviceGateway::begin_without_base() {
  const pipeline::Config& config = service_.setup().config.config;
  if (config.odometry_source == pipeline::OdometrySource::kRecorded) {
    spdlog::warn("no base configured: odometry reports a standing robot");
    return;
  }
  spdlog::info("no base configured: odometry from the scans");
  laser_odometry_.emplace(pipeline::laser_odometry(config.local_mapper));
}

std::vector<scan::Scan> DeviceGateway::placed(scan::Scan scan) {
  std::vector<scan::Scan> scans;
  if (laser_odometry_) {
    laser_odometry_->add(std::move(scan));
    scans = laser_odometry_->take();
    for (scan::Scan& ready : scans) ready.odometry_epoch += odometry_epoch_;
    service_.status().set_drops("match no others", laser_odometry_->counts().unplaced);
    service_.status().set_drops("between bare walls", laser_odometry_->counts().unseen);
    if (laser_odometry_->counts().breaks > breaks_) {
      breaks_ = laser_odometry_->counts().breaks;
      service_.status().fault("track of the scans lost", "the place is found again by the scans");
    }
  } else {
    scans.push_back(std::move(scan));
  }
  numbered_ = scans.empty() ? numbered_ : scans.back().sequence + 1;
  return scans;
}

void DeviceGateway::compare_watchdog(double watchdog_s) {
  const double counted_s = service_.setup().config.config.navigator.guard.runs_on_s;
  if (watchdog_s <= counted_s) return;
  service_.status().fault(
      "watchdog longer than the guards count",
      fmt::format("base.watchdog_s is {:g} s, expected at most guard.runs_on_s, {:g} s", watchdog_s,
                  counted_s));
}

void DeviceGateway::remember() {
  if (!base_) return;  // while it is being made
  const std::optional<devices::OdometerState> state = base_->odometer_state();
  if (!state) return;
  memory_.store({*state, odometry_epoch_, gate_.scans(), time_.stamp_ns(support::monotonic_ns())});
}

bool DeviceGateway::publish(const scan::Scan& scan) {
  msg::Scan message = service::to_msg(scan, service_.robot_id());
  message.stamp_ns(time_.stamp_ns(scan.stamp_ns));
  if (!scans_.write(message)) {
    service_.status().fault("send blocked", "scan " + std::to_string(scan.sequence));
    return false;
  }
  last_stamp_ns_ = message.stamp_ns();
  ++sent_;
  service_.status().count_input("scan");
  return true;
}

void DeviceGateway::read_body() {
  const std::int64_t now_ns = support::monotonic_ns();
  body_->publish(now_ns, time_.stamp_ns(now_ns));
}

void DeviceGateway::publish_state() {
  std::string text;
  std::string missing;
  if (laser_) {
    laser_->count();
    if (!laser_->running()) missing = "laser";
    text += "laser " + laser_->describe();
  }
  if (base_) {
    base_->count();
    if (!base_->ready()) missing += missing.empty() ? "base" : " and base";
    text += (text.empty() ? "base " : "; base ") + base_->describe();
  }
  if (body_ && !body_->fault().empty()) {
    missing += missing.empty() ? "body sensors" : " and body sensors";
    text += "; " + body_->fault();
  }
  messaging::StatusPublisher& status = service_.status();
  status.set_counter("scan_latency_ms", static_cast<double>(latency_ns_) * 1e-6);
  status.set_counter("scan_latency_largest_ms", static_cast<double>(largest_latency_ns_) * 1e-6);
  status.set_counter("scan_wait_ms", static_cast<double>(wait_ns_) * 1e-6);
  const msg::ServiceState state = missing.empty() ? msg::kServiceRunning : msg::kServiceWaiting;
  if (text == published_ && state == status.state()) return;
  published_ = text;
  spdlog::info("{}", text);
  status.set_state(state, text);
  status.set_waits_for(missing);
}

template <class T>
bool DeviceGateway::deliver(messaging::Writer<T>& writer, std::chrono::nanoseconds timeout) {
  const auto end = std::chrono::steady_clock::now() + timeout;
  while (!writer.wait_for_acknowledgments(kDeliveryPoll)) {
    if (std::chrono::steady_clock::now() >= end) return false;
    static_cast<void>(service_.loop().run_for(kDeliveryPoll));
  }
  return true;
}

void DeviceGateway::finish() {
  if (base_) base_->stop();
  if (laser_) laser_->finish();
  ended_ = true;
  publish_state();
  const auto end_ns = support::monotonic_ns() + std::chrono::nanoseconds(kLastDelivery).count();
  if (!deliver(scans_, kLastDelivery)) {
    service_.status().fault("readers missed scans", "at the end");
  }
  const std::chrono::nanoseconds left(std::max<std::int64_t>(0, end_ns - support::monotonic_ns()));
  if (base_ && !deliver(base_->odometry(), left)) {
    service_.status().fault("readers missed odometry", "at the end");
  }
  msg::StreamEnd end;
  messaging::set_header(end, service_.robot_id(), last_stamp_ns_, 0);
  end.stage(msg::kStageGateway);
  end.count(numbered_);
  end.last_id(numbered_ == 0 ? 0 : numbered_ - 1);
  if (!stream_end_.write(end) || !deliver(stream_end_, kLastDelivery)) {
    service_.status().fault("readers missed the stream end", "at the end");
  }
  // The sender of a halt that has arrived takes it for delivered. A signal ends the first turn.
  while (service_.loop().run_for(milliseconds::zero())) {
  }
  spdlog::info("{} scans published", sent_);
}

}  // namespace topogeo::sensor_gateway
