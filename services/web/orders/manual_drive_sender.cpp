#include "orders/manual_drive_sender.hpp"

#include <chrono>
#include <exception>
#include <stdexcept>
#include <utility>

#include "topogeo/geometry/reaction_times.hpp"
#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/service/base_confirmation.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/service/navigation_conversions.hpp"
#include "topogeo/support/host.hpp"
#include "topogeo/support/log.hpp"

#include "channels/event_log.hpp"
#include "server/json_values.hpp"

namespace topogeo::web {
namespace {

constexpr std::chrono::milliseconds kHandPeriod{50};        // as for the navigator
constexpr std::chrono::milliseconds kLastHandCommand{200};  // lets the gateway get the last one
constexpr std::int64_t kZeroPeriod_ns = 500'000'000;        // during a stop that no base reports

}  // namespace

ManualDriveSender::ManualDriveSender(messaging::EventLoop& loop, const service::Service& service,
                                     ChannelHub& hub, EventLog& events, Tally& tally, Hooks hooks,
                                     const std::filesystem::path& memory)
    : loop_(loop),
      service_(service),
      hub_(hub),
      events_(events),
      tally_(tally),
      hooks_(std::move(hooks)),
      client_id_(support::process_name()),
      clock_(support::wall_clock_ns() - support::monotonic_ns()),
      guard_(service.setup().config.config.navigator.guard),
      drive_(service.setup().config.config.navigator.follower),
      commands_(service.participant()),
      orders_(service.participant()),
      kept_stop_(memory) {
  listen();
  if (stop_wanted_) {
    const std::string age = service::age_in_words(kept_stop_.age_at_start());
    events_.add(EventLog::Level::kWarning, "web",
                "the operator's stop of before this start holds until the release" +
                    (age.empty() ? "" : " (" + age + ")"));
    show_rest();
  }
  loop_.add_timer(kHandPeriod, [this] { tick(); });
}

template <class T, class Handler>
void ManualDriveSender::subscribe(Handler handler) {
  loop_.add<T>(messaging::Reader<T>(service_.participant()),
               [this, handler](const T& message, const messaging::SampleInfo& info) {
                 if (message.robot_id() == service_.robot_id()) handler(message, info);
               });
}

void ManualDriveSender::listen() {
  using Info = messaging::SampleInfo;
  subscribe<msg::Odometry>(
      [this](const msg::Odometry& odometry, const Info&) { on_odometry(odometry); });
  subscribe<msg::Sonar>(
      [this](const msg::Sonar& sonar, const Info&) { guard_.add(service::sonar_from_msg(sonar)); });
  subscribe<msg::Scan>([this](const msg::Scan& scan, const Info&) { on_scan(scan); });
  subscribe<msg::LivePose>([this](const msg::LivePose& pose, const Info&) { on_pose(pose); });
  subscribe<msg::LaserStatus>(
      [this](const msg::LaserStatus& laser, const Info&) { on_laser(laser); });
  subscribe<msg::BaseStatus>(
      [this](const msg::BaseStatus& base, const Info& info) { on_base(base, info.writer); });
  subscribe<msg::BaseCommand>([this](const msg::BaseCommand& message, const Info& info) {
    on_order(message, info.writer);
  });
  subscribe<msg::NavigatorStatus>(
      [this](const msg::NavigatorStatus&, const Info& info) { on_navigator(info.writer); });
}

ManualDriveSender::~ManualDriveSender() {
  if (!commanding_) return;
  try {
    command({}, clock_.now_ns(support::monotonic_ns()));
    static_cast<void>(commands_.wait_for_acknowledgments(kLastHandCommand));
  } catch (const std::exception& error) {
    spdlog::error("the last command was not sent: {}", error.what());
  }
}

void ManualDriveSender::on_odometry(const msg::Odometry& odometry) {
  clock_.observe(odometry.stamp_ns(), support::monotonic_ns());
  guard_.add(service::odometry_from_msg(odometry));
}

void ManualDriveSender::on_pose(const msg::LivePose& pose) {
  if (pose.state() != msg::kStateTracking) return;  // the guard carries the previous points on
  pose_.emplace();
  pose_->stamp_ns = pose.stamp_ns();
  pose_->T_map_robot = service::from_msg(pose.T_map_robot());
}

void ManualDriveSender::on_scan(const msg::Scan& message) {
  const navigation::ScanPoints scan = service::to_scan_points(
      service::from_msg(message), service_.setup().config.config.local_mapper.T_robot_laser);
  clock_.observe(scan.stamp_ns, support::monotonic_ns());
  guard_.add(navigation::OdometrySample{scan.stamp_ns, scan.T_odom_robot});
  guard_.add(scan);
}

void ManualDriveSender::on_laser(const msg::LaserStatus& laser) {
  guard_.add(
      navigation::LaserFields{laser.stamp_ns(), laser.warning_field(), laser.protective_field()});
}

void ManualDriveSender::on_base(const msg::BaseStatus& base, const messaging::Handle& writer) {
  base_ = writer;
  stop_count_ = base.stop_count();
  kept_stop_.base_counts(stop_count_);
  const bool was_held = std::exchange(base_held_, service::holds(base));
  if (base_held_) kept_stop_.hand_over();
  if (was_held && !base_held_ && !hides_stop(base) && !releasing_.empty()) {
    events_.add(EventLog::Level::kInfo, "web", "released by " + std::exchange(releasing_, {}));
  }
  end_release(release_.take(base, support::monotonic_ns()));
  if (!stop_wanted_) return;
  if (base_held_) {
    stopped_base_ = writer;
  } else if (hides_stop(base)) {
    return;  // its stop is not reported meanwhile
  } else if (stopped_base_ == writer) {
    stop_wanted_ = false;  // another operator has released it
    stop_unheard_ = false;
    show_rest();
  } else {
    // The halt went to a gateway that died, or is still on its way: a second one does no harm.
    static_cast<void>(order(msg::kBaseHalt, stop_number_));
  }
}

void ManualDriveSender::on_order(const msg::BaseCommand& message, const messaging::Handle& writer) {
  if (message.client_id() == client_id_.c_str()) return;
  const std::string client = message.client_id().c_str();
  if (message.kind() != msg::kBaseSetLimits) releasing_.clear();
  if (!kept_stop_.take(message, writer)) {
    if (message.kind() == msg::kBaseReset && base_held_) releasing_ = client;
    return;
  }
  if (kept_stop_.holds()) {
    drive_.let_go(support::monotonic_ns());
    events_.add(EventLog::Level::kWarning, "web", "stopped by " + client);
    tick();
  } else {
    if (!base_hears()) stop_wanted_ = false;
    stop_unheard_ = false;
    events_.add(EventLog::Level::kInfo, "web", "released by " + client);
  }
  if (!commanding_) show_rest();
}

void ManualDriveSender::on_navigator(const messaging::Handle& navigator) {
  if (base_hears() || navigator_ == navigator || !orders_.connected_with(navigator)) return;
  navigator_ = navigator;
  if (kept_stop_.number() == 0) return;
  static_cast<void>(
      order(kept_stop_.holds() ? msg::kBaseHalt : msg::kBaseReset, kept_stop_.number()));
}

void ManualDriveSender::keep_off(std::shared_ptr<const navigation::DrawnLimits> limits) {
  limits_ = std::move(limits);
}

void ManualDriveSender::keep_off_drawn() {
  if (!pose_ || !limits_) return;
  guard_.keep_off(pose_->stamp_ns, limits_->near_m(pose_->T_map_robot));
  pose_.reset();
}

void ManualDriveSender::drive(std::uint64_t viewer, const geometry::Velocity& wanted,
                              std::int64_t came_ns) {
  const std::int64_t now_ns = support::monotonic_ns();
  if (now_ns - came_ns > ManualDrive::kPatience_ns) {
    tally_.add("refused: late");
    return;
  }
  if (stop_wanted_ || stopped_alone()) {  // a base of ROS takes no order to halt
    tally_.add("refused: stopped");
    return;
  }
  const bool first = !drive_.held(now_ns);
  if (!drive_.hold(viewer, wanted, now_ns)) {
    tally_.add("refused: another drives");
    return;
  }
  if (first) {
    limits_.reset();
    events_.add(EventLog::Level::kInfo, "web", "driven by hand");
    hooks_.on_first();
  }
  tick();
}

void ManualDriveSender::release(std::uint64_t viewer) {
  drive_.release(viewer, support::monotonic_ns());
  tick();
}

void ManualDriveSender::tick() {
  if (stop_unheard_ && base_hears()) stop_unheard_ = !order(msg::kBaseHalt, stop_number_);
  if (navigator_ && !orders_.connected_with(*navigator_)) navigator_.reset();
  const std::int64_t now_ns = support::monotonic_ns();
  end_release(release_.check(now_ns));
  const std::int64_t stamp_ns = clock_.now_ns(now_ns);
  // Earlier measurements would count as fresh until the clock reaches their stamps again.
  if (clock_.take_set_back()) {
    guard_ = navigation::CollisionGuard(service_.setup().config.config.navigator.guard);
    pose_.reset();
  }
  held_ = drive_.held(now_ns);
  if (held_) keep_off_drawn();
  auto verdict = drive_.step(guard_, now_ns, stamp_ns);
  if (!verdict) {
    if (commanding_ || shows_stop_ != stopped_alone()) show_rest();
    commanding_ = false;
    if (stopped_alone() && now_ns >= zero_due_ns_) {
      // A navigator that does not have the stop yet may drive: these zeros interrupt it.
      zero_due_ns_ = navigator_ ? now_ns + kZeroPeriod_ns : now_ns;
      command({}, stamp_ns);
    }
    return;
  }
  if (held_ && !limits_) {
    verdict->allowed = {};
    verdict->message = "waiting for the drawing of the map";
  }
  commanding_ = true;
  command(verdict->allowed, stamp_ns);
  show(*verdict, held_);
}

void ManualDriveSender::command(const geometry::Velocity& velocity, std::int64_t stamp_ns) {
  msg::MotionCommand message;
  messaging::set_header(message, service_.robot_id(), stamp_ns, commands_sent_++);
  message.linear_mps(velocity.linear_m_per_s);
  message.angular_radps(velocity.angular_rad_per_s);
  message.valid_for_s(geometry::kCommandValid_s);
  if (!commands_.write(message)) hooks_.on_blocked("motion command");
  tally_.add("commands");
}

// Another robot's base may already be connected when the own one is not.
bool ManualDriveSender::base_hears() const {
  return base_ && orders_.connected_with(*base_);
}

bool ManualDriveSender::stop() {
  drive_.let_go(support::monotonic_ns());
  release_.end();
  if (on_release_) std::exchange(on_release_, nullptr)(UnconfirmedRelease::Outcome::kRefused);
  stop_number_ = service::OperatorStop::new_number();
  const bool heard = order(msg::kBaseHalt, stop_number_);
  stop_unheard_ = !heard;
  stop_wanted_ = true;
  stopped_base_.reset();
  tick();                         // zeros stop a base of ROS, which takes no order to halt
  kept_stop_.hold(stop_number_);  // after the orders, because a disk may be slow
  events_.add(EventLog::Level::kWarning, "web",
              heard ? "stopped by the operator" : "no base received the operator's stop");
  if (!commanding_) show_rest();
  return heard;
}

ManualDriveSender::Release ManualDriveSender::release_stop(OnRelease done) {
  using Outcome = UnconfirmedRelease::Outcome;
  const bool kept = stopped_alone();
  const bool stopped = std::exchange(stop_wanted_, false) || kept;
  stop_unheard_ = false;
  releasing_.clear();
  const std::uint64_t number = kept_stop_.number();
  const bool base_decides = !kept_stop_.holds();
  kept_stop_.release();
  if (stopped) show_rest();
  const bool heard = order(msg::kBaseReset, base_ ? stop_count_ : number);
  // The base may have reported no stop yet: a navigator then knows it by this number alone.
  if (base_ && !base_decides) static_cast<void>(order(msg::kBaseReset, number));
  if (kept) {
    events_.add(EventLog::Level::kInfo, "web", "released by the operator; no base reports it");
    return Release::kHeldHere;
  }
  if (!heard) return Release::kUnheard;
  if (on_release_) std::exchange(on_release_, nullptr)(Outcome::kUnconfirmed);
  on_release_ = std::move(done);
  release_.begin(stop_count_, base_held_, support::monotonic_ns());
  return Release::kSent;
}

void ManualDriveSender::end_release(std::optional<UnconfirmedRelease::Outcome> outcome) {
  using Level = EventLog::Level;
  if (!outcome) return;
  switch (*outcome) {
    case UnconfirmedRelease::Outcome::kReleased:
      events_.add(Level::kInfo, "web", "released by the operator");
      break;
    case UnconfirmedRelease::Outcome::kRefused:
      events_.add(Level::kWarning, "web",
                  "the base refused the operator's release: it was stopped again meanwhile");
      break;
    case UnconfirmedRelease::Outcome::kUnconfirmed:
      events_.add(Level::kWarning, "web", "the base has not confirmed the operator's release");
      break;
  }
  if (on_release_) std::exchange(on_release_, nullptr)(*outcome);
}

bool ManualDriveSender::order(msg::BaseCommandKind kind, std::uint64_t number) {
  msg::BaseCommand message;
  messaging::set_header(message, service_.robot_id(), support::wall_clock_ns(), orders_sent_++);
  messaging::set_client_id(message, client_id_);
  message.kind(kind);
  message.stop_count(number);
  const bool heard = base_hears();  // before sending: a later base may miss it
  if (orders_.write(message)) return heard;
  hooks_.on_blocked("base command");
  return false;
}

void ManualDriveSender::show_rest() {
  shows_stop_ = stopped_alone();
  if (!shows_stop_) return hub_.set(Channel::kDrive, "null");
  navigation::GuardVerdict verdict;
  verdict.message = "stopped; takes orders after a release";
  show(verdict, false);
}

void ManualDriveSender::show(const navigation::GuardVerdict& verdict, bool held) {
  const double ahead = verdict.allowed.linear_m_per_s;
  hub_.set(Channel::kDrive,
           text_of(Json{{"held", held},
                        {"stopped", stopped_alone()},
                        {"linear_mps", rounded(verdict.allowed.linear_m_per_s)},
                        {"angular_radps", rounded(verdict.allowed.angular_rad_per_s)},
                        {"free_ahead_m", held && ahead >= 0.0 ? rounded(verdict.free_m) : Json()},
                        {"free_behind_m", held && ahead < 0.0 ? rounded(verdict.free_m) : Json()},
                        {"message", verdict.message}}));
}

}  // namespace topogeo::web
