#include "laser_channel.hpp"

#include <chrono>
#include <utility>
#include <vector>

#include "topogeo/devices/laser_models.hpp"
#include "topogeo/messaging/message.hpp"

namespace topogeo::sensor_gateway {

namespace {

/// Same as for all statuses: twice a second.
constexpr std::chrono::milliseconds kLaserStatusPeriod{500};
/// Time for the last orders to leave the port.
constexpr std::chrono::milliseconds kLastOrders{200};
/// The scan rate is averaged over this window: at 9600 baud a scan takes 0.8 s.
constexpr std::int64_t kRateWindow_ns = 4'000'000'000;

/// Numbers of dropped scans and bytes by reason, with the same names everywhere.
std::vector<std::pair<std::string, std::uint64_t>> drops_of(const devices::LaserHealth& health,
                                                            const LineStatistics& line,
                                                            const ScanGate& gate) {
  std::vector<std::pair<std::string, std::uint64_t>> drops = health.drops;
  drops.emplace_back("bytes before a change of the line", line.bytes_stale);
  for (std::size_t i = 0; i < kScanDrops; ++i) {
    const auto drop = static_cast<ScanDrop>(i);
    drops.emplace_back(describe(drop), gate.dropped(drop));
  }
  return drops;
}

PortOptions port_options(const DeviceConfig& config) {
  PortOptions options{config.laser_port};
  options.data_port = config.laser_data_port;
  return options;
}

std::string_view name(msg::LaserState state) {
  switch (state) {
    case msg::kLaserRunning:
      return "running";
    case msg::kLaserStarting:
      return "starting";
    case msg::kLaserFault:
      return "fault";
    case msg::kLaserOffline:
      break;
  }
  return "offline";
}

}  // namespace

LaserChannel::LaserChannel(service::Service& service, const DeviceConfig& config,
                           const HostTime& time, ScanGate& gate,
                           const std::filesystem::path& memory,
                           std::function<void(const devices::LaserScan&)> on_scan,
                           std::function<void(std::int64_t)> on_scans)
    : service_(service),
      time_(time),
      gate_(gate),
      memory_(memory),
      on_scan_(std::move(on_scan)),
      on_scans_(std::move(on_scans)),
      driver_(devices::make_laser_driver(config.laser)),
      statuses_(service.advertise<msg::LaserStatus>()),
      line_(service.loop(), *driver_, port_options(config),
            [this](std::int64_t now_ns) { after_driver(now_ns); }) {
  if (const auto remembered = memory_.load()) driver_->resume(*remembered);
  timer_ = service_.loop().add_timer(kLaserStatusPeriod, [this] { publish_status(); });
}

LaserChannel::~LaserChannel() {
  service_.loop().cancel_timer(timer_);
}

void LaserChannel::after_driver(std::int64_t now_ns) {
  std::vector<devices::LaserScan> scans = driver_->take_scans();
  for (devices::LaserScan& scan : scans) {
    beams_ = static_cast<std::uint32_t>(scan.ranges_m.size());
    dazzled_ = static_cast<std::uint32_t>(scan.dazzled);
    warning_field_ = scan.warning_field;
    protective_field_ = scan.protective_field;
    recent_ns_.push_back(now_ns);
    on_scan_(scan);
    gate_.add(std::move(scan), now_ns);
  }
  if (!scans.empty()) {
    on_scans_(now_ns);
    memory_.store(driver_->health().line);
  }
  const bool fields_changed =
      warning_field_ != published_warning_ || protective_field_ != published_protective_;
  if (state(driver_->health()) != published_state_ || fields_changed) publish_status();
}

void LaserChannel::finish() {
  driver_->end(line_.now_ns());
  line_.carry_out();
  static_cast<void>(line_.wait_written(kLastOrders));
}

bool LaserChannel::running() const {
  return state(driver_->health()) == msg::kLaserRunning;
}

msg::LaserState LaserChannel::state(const devices::LaserHealth& health) const {
  switch (health.state) {
    case devices::LaserState::kStarting:
      return msg::kLaserStarting;
    case devices::LaserState::kRunning:
      return fault(health).empty() ? msg::kLaserRunning : msg::kLaserFault;
    case devices::LaserState::kOffline:
    case devices::LaserState::kFailed:
      break;
  }
  return msg::kLaserOffline;
}

std::string LaserChannel::reason(const devices::LaserHealth& health) const {
  if (!line_.why_closed().empty()) return line_.why_closed();
  const std::string why = health.state == devices::LaserState::kRunning ? fault(health) : "";
  return why.empty() ? health.reason
                     : why;  // that of a running one: its rate is not the wanted one
}

std::string LaserChannel::fault(const devices::LaserHealth& health) const {
  return line_.why_closed().empty() ? health.fault : line_.why_closed();
}

std::string LaserChannel::describe() const {
  const devices::LaserHealth health = driver_->health();
  const std::string why = reason(health);
  const std::string text(name(state(health)));
  return why.empty() ? text : text + ": " + why;
}

void LaserChannel::publish_status() {
  const devices::LaserHealth health = driver_->health();
  const std::int64_t now_ns = line_.now_ns();
  while (!recent_ns_.empty() && recent_ns_.front() < now_ns - kRateWindow_ns) {
    recent_ns_.pop_front();
  }
  const msg::LaserState state_now = state(health);
  published_state_ = state_now;
  published_warning_ = warning_field_;
  published_protective_ = protective_field_;
  msg::LaserStatus message;
  messaging::set_header(message, service_.robot_id(), time_.stamp_ns(now_ns), statuses_sent_);
  message.state(state_now);
  messaging::set_text_cut(message.reason(), reason(health));
  message.baud(line_.is_open() ? health.line.baud : 0);
  message.beams(beams_);
  message.contaminated(health.contaminated);
  message.implausible(health.implausible);
  message.error_level(health.error_level);
  message.dazzled_beams(dazzled_);
  message.warning_field(warning_field_);
  message.protective_field(protective_field_);
  message.scans(gate_.scans());
  message.scans_per_s(static_cast<double>(recent_ns_.size()) * 1e9 /
                      static_cast<double>(kRateWindow_ns));
  for (const auto& [drop, count] : drops_of(health, line_.statistics(), gate_)) {
    if (count == 0) continue;
    msg::FaultCount entry;
    messaging::set_text(entry.reason(), drop, "reason");
    entry.count(count);
    message.drops().push_back(entry);
  }
  if (statuses_.write(message)) {
    ++statuses_sent_;
  } else {
    service_.status().fault("send blocked", "laser status");
  }
}

void LaserChannel::count() {
  messaging::StatusPublisher& publisher = service_.status();
  const devices::LaserHealth health = driver_->health();
  const auto set = [&](const std::string& counter, std::uint64_t value) {
    publisher.set_counter(counter, static_cast<double>(value));
  };
  set("scans_sent", gate_.scans());
  set("scans_with_extrapolated_odometry", gate_.extrapolated());
  set("beams", beams_);
  set("laser_baud", health.line.baud);
  set("laser_port_opened", line_.statistics().opened);
  set("laser_searches", health.searches);
  for (const auto& [drop, count] : drops_of(health, line_.statistics(), gate_)) {
    publisher.set_drops(drop, count);
  }
}

}  // namespace topogeo::sensor_gateway
