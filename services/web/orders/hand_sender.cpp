#include "orders/hand_sender.hpp"

#include <chrono>
#include <exception>
#include <stdexcept>
#include <utility>

#include "topogeo/messaging/message.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/service/navigation_conversions.hpp"
#include "topogeo/support/host.hpp"
#include "topogeo/support/log.hpp"

#include "channels/event_log.hpp"
#include "server/json_values.hpp"

namespace topogeo::web {
namespace {

constexpr std::chrono::milliseconds kHandPeriod{50};        // as the navigator
constexpr std::chrono::milliseconds kLastHandCommand{200};  // for the gateway to have the last one
constexpr double kHandValid_s = 0.3;  // a base runs on that long when this service dies

std::int64_t steady_ns() {
  return std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

HandSender::HandSender(service::Service& service, Board& board, EventLog& events, MapSource map,
                       std::function<void(const msg::Odometry&)> on_odometry)
    : service_(service),
      board_(board),
      events_(events),
      map_source_(std::move(map)),
      client_id_(support::process_name()),
      clock_(support::wall_clock_ns() - steady_ns()),
      guard_(service.setup().config.config.navigator.guard),
      drive_(service.setup().config.config.navigator.follower),
      commands_(service.advertise<msg::MotionCommand>()),
      orders_(service.advertise<msg::BaseCommand>()) {
  service.subscribe<msg::Odometry>(
      [this, on_odometry = std::move(on_odometry)](const msg::Odometry& odometry) {
        clock_.observe(odometry.stamp_ns(), steady_ns());
        guard_.add(service::odometry_from_msg(odometry));
        if (on_odometry) on_odometry(odometry);
      });
  service.subscribe<msg::Sonar>(
      [this](const msg::Sonar& sonar) { guard_.add(service::sonar_from_msg(sonar)); });
  service.loop().add_timer(kHandPeriod, [this] { tick(); });
}

HandSender::~HandSender() {
  if (!commanding_) return;
  try {
    command({}, clock_.now_ns(steady_ns()));
    static_cast<void>(commands_.wait_for_acknowledgments(kLastHandCommand));
  } catch (const std::exception& error) {
    spdlog::error("the last command was not sent: {}", error.what());
  }
}

void HandSender::take(const msg::LivePose& pose) {
  if (pose.state() != msg::kStateTracking) return;  // the points of before are carried on
  pose_.emplace();
  pose_->stamp_ns = pose.stamp_ns();
  pose_->T_map_robot = service::from_msg(pose.T_map_robot());
}

void HandSender::keep_off_drawn() {
  try {
    if (auto map = map_source_(); map && map != map_) {
      limits_ = navigation::DrawnLimits(map->space());
      map_ = std::move(map);
    }
  } catch (const std::invalid_argument& error) {
    service_.status().fault("invalid hybrid map", error.what());
  }
  if (!pose_) return;
  guard_.keep_off(pose_->stamp_ns, limits_.near_m(pose_->T_map_robot));
  pose_.reset();
}

void HandSender::take(const navigation::ScanPoints& scan) {
  clock_.observe(scan.stamp_ns, steady_ns());
  guard_.add(navigation::OdometrySample{scan.stamp_ns, scan.T_odom_robot});
  guard_.add(scan);
}

void HandSender::take(const msg::LaserStatus& laser) {
  guard_.add(
      navigation::LaserFields{laser.stamp_ns(), laser.warning_field(), laser.protective_field()});
}

void HandSender::drive(std::uint64_t viewer, const geometry::Velocity& wanted,
                       const std::function<void()>& on_first) {
  const bool first = !drive_.held(steady_ns());
  if (!drive_.hold(viewer, wanted, steady_ns())) {
    service_.status().add_drops("refused: another drives");
    return;
  }
  if (first) {
    events_.add(EventLog::Level::kInfo, "web", "driven by hand");
    on_first();
  }
  tick();
}

void HandSender::release(std::uint64_t viewer) {
  drive_.release(viewer, steady_ns());
  tick();
}

void HandSender::tick() {
  if (stop_unheard_ && base_hears()) stop_unheard_ = !order(msg::kBaseHalt);
  const std::int64_t now_ns = steady_ns();
  const std::int64_t stamp_ns = clock_.now_ns(now_ns);
  const bool held = drive_.held(now_ns);
  if (held) keep_off_drawn();
  const auto verdict = drive_.step(guard_, now_ns, stamp_ns);
  if (!verdict) {
    if (commanding_) board_.set(Channel::kDrive, "null");
    commanding_ = false;
    return;
  }
  commanding_ = true;
  command(verdict->allowed, stamp_ns);
  show(*verdict, held);
}

void HandSender::command(const geometry::Velocity& velocity, std::int64_t stamp_ns) {
  msg::MotionCommand message;
  messaging::set_header(message, service_.robot_id(), stamp_ns, commands_sent_++);
  message.linear_mps(velocity.linear_m_per_s);
  message.angular_radps(velocity.angular_rad_per_s);
  message.valid_for_s(kHandValid_s);
  if (!commands_.write(message)) service_.status().fault("send blocked", "motion command");
  service_.status().add_to_counter("commands");
}

void HandSender::note_base(const messaging::Handle& base) {
  base_ = base;
}

// The base of another robot may be connected already when that of the own one is not.
bool HandSender::base_hears() const {
  return base_ && orders_.connected_with(*base_);
}

bool HandSender::stop() {
  drive_ = ManualDrive(service_.setup().config.config.navigator.follower);
  const bool heard = order(msg::kBaseHalt);
  stop_unheard_ = !heard;
  events_.add(EventLog::Level::kWarning, "web",
              heard ? "stopped by the operator" : "the operator's stop is heard by no base");
  return heard;
}

bool HandSender::release_stop() {
  stop_unheard_ = false;
  const bool heard = order(msg::kBaseReset);
  if (heard) events_.add(EventLog::Level::kInfo, "web", "the operator lets it move again");
  return heard;
}

bool HandSender::order(msg::BaseCommandKind kind) {
  msg::BaseCommand message;
  messaging::set_header(message, service_.robot_id(), support::wall_clock_ns(), orders_sent_++);
  messaging::set_client_id(message, client_id_);
  message.kind(kind);
  const bool heard = base_hears();  // before it is sent, or it may be lost after all
  service_.send(orders_, message, "base command");
  return heard;
}

void HandSender::show(const navigation::GuardVerdict& verdict, bool held) {
  board_.set(Channel::kDrive,
             text_of(Json{{"held", held},
                          {"linear_mps", rounded(verdict.allowed.linear_m_per_s)},
                          {"angular_radps", rounded(verdict.allowed.angular_rad_per_s)},
                          {"free_ahead_m", rounded(verdict.free_m)},
                          {"message", verdict.message}}));
}

}  // namespace topogeo::web
