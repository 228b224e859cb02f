#include "laser_channel.hpp"

#include <chrono>
#include <utility>
#include <vector>

#include "topogeo/messaging/message.hpp"

namespace topogeo::sensor_gateway {

namespace {

/// Same as for all statuses: twice a second.
constexpr std::chrono::milliseconds kLaserStatusPeriod{500};
/// The scan rate is averaged over this window: at 9600 baud a scan takes 0.8 s.
constexpr std::int64_t kRateWindow_ns = 4'000'000'000;

/// Numbers of dropped scans and bytes by reason, with the same names everywhere.
std::vector<std::pair<std::string, std::uint64_t>> drops_of(const devices::PlsCounters& counters,
                                                            const LineStatistics& line,
                                                            const ScanGate& gate) {
  std::vector<std::pair<std::string, std::uint64_t>> drops = {
      {"bad checksum", counters.line.bad_crc},
      {"implausible length", counters.line.implausible_length},
      {"truncated telegram", counters.line.truncated},
      {"noise bytes", counters.line.noise_bytes},
      {"echoes", counters.line.echoes},
      {"bytes before a change of the line", line.bytes_stale},
      {"unexpected number of beams", counters.scan_drops.beam_count},
      {"interlaced scan", counters.scan_drops.interlaced},
      {"implausible scan", counters.scan_drops.implausible},
      {"laser reports an error", counters.scan_drops.sensor_error},
      {"stuck scan", counters.scan_drops.stuck},
      {"scan while being set up", counters.unsolicited}};
  for (std::size_t i = 0; i < kScanDrops; ++i) {
    const auto drop = static_cast<ScanDrop>(i);
    drops.emplace_back(describe(drop), gate.dropped(drop));
  }
  return drops;
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
                           std::function<void(const devices::PlsScan&)> on_scan,
                           std::function<void(std::int64_t)> on_scans)
    : service_(service),
      time_(time),
      gate_(gate),
      memory_(memory),
      on_scan_(std::move(on_scan)),
      on_scans_(std::move(on_scans)),
      driver_(config.laser),
      statuses_(service.advertise<msg::LaserStatus>()),
      line_(service.loop(), driver_, PortOptions{config.laser_port},
            [this](std::int64_t now_ns) { after_driver(now_ns); }) {
  if (const auto remembered = memory_.load()) driver_.resume(*remembered);
  timer_ = service_.loop().add_timer(kLaserStatusPeriod, [this] { publish_status(); });
}

LaserChannel::~LaserChannel() {
  service_.loop().cancel_timer(timer_);
}

void LaserChannel::after_driver(std::int64_t now_ns) {
  std::vector<devices::PlsScan> scans = driver_.take_scans();
  for (devices::PlsScan& scan : scans) {
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
    memory_.store(driver_.status().line);
  }
  const bool fields_changed =
      warning_field_ != published_warning_ || protective_field_ != published_protective_;
  if (state(driver_.status()) != published_state_ || fields_changed) publish_status();
}

bool LaserChannel::running() const {
  return state(driver_.status()) == msg::kLaserRunning;
}

msg::LaserState LaserChannel::state(const devices::PlsStatus& status) const {
  switch (status.state) {
    case devices::PlsState::kDetecting:
    case devices::PlsState::kConfiguring:
      return msg::kLaserStarting;
    case devices::PlsState::kRunning:
      return fault(status).empty() ? msg::kLaserRunning : msg::kLaserFault;
    case devices::PlsState::kOffline:
    case devices::PlsState::kFailed:
      break;
  }
  return msg::kLaserOffline;
}

std::string LaserChannel::reason(const devices::PlsStatus& status) const {
  if (!line_.why_closed().empty()) return line_.why_closed();
  const std::string why = status.state == devices::PlsState::kRunning ? fault(status) : "";
  return why.empty() ? status.reason
                     : why;  // that of a running one: its rate is not the wanted one
}

std::string LaserChannel::fault(const devices::PlsStatus& status) const {
  if (!line_.why_closed().empty()) return line_.why_closed();
  if (status.stuck) return "the laser repeats the same scan";
  if (status.health.implausible) return "the laser reports implausible measurements";
  if (status.health.severity >= devices::PlsSeverity::kError) return "the laser reports an error";
  return {};
}

std::string LaserChannel::describe() const {
  const devices::PlsStatus status = driver_.status();
  const std::string why = reason(status);
  const std::string text(name(state(status)));
  return why.empty() ? text : text + ": " + why;
}

void LaserChannel::publish_status() {
  const devices::PlsStatus status = driver_.status();
  const std::int64_t now_ns = line_.now_ns();
  while (!recent_ns_.empty() && recent_ns_.front() < now_ns - kRateWindow_ns) {
    recent_ns_.pop_front();
  }
  const msg::LaserState state_now = state(status);
  published_state_ = state_now;
  published_warning_ = warning_field_;
  published_protective_ = protective_field_;
  msg::LaserStatus message;
  messaging::set_header(message, service_.robot_id(), time_.stamp_ns(now_ns), statuses_sent_);
  message.state(state_now);
  messaging::set_text_cut(message.reason(), reason(status));
  message.baud(line_.is_open() ? status.line.baud : 0);
  message.beams(beams_);
  message.contaminated(status.health.polluted);
  message.implausible(status.health.implausible);
  message.error_level(static_cast<std::uint16_t>(status.health.severity));
  message.dazzled_beams(dazzled_);
  message.warning_field(warning_field_);
  message.protective_field(protective_field_);
  message.scans(gate_.scans());
  message.scans_per_s(static_cast<double>(recent_ns_.size()) * 1e9 /
                      static_cast<double>(kRateWindow_ns));
  for (const auto& [drop, count] : drops_of(status.counters, line_.statistics(), gate_)) {
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
  const devices::PlsStatus status = driver_.status();
  const auto set = [&](const std::string& counter, std::uint64_t value) {
    publisher.set_counter(counter, static_cast<double>(value));
  };
  set("scans_sent", gate_.scans());
  set("scans_with_extrapolated_odometry", gate_.extrapolated());
  set("beams", beams_);
  set("laser_baud", status.line.baud);
  set("laser_port_opened", line_.statistics().opened);
  set("laser_searches", status.counters.searches);
  for (const auto& [drop, count] : drops_of(status.counters, line_.statistics(), gate_)) {
    publisher.set_drops(drop, count);
  }
}

}  // namespace topogeo::sensor_gateway
