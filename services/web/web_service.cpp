#include "web_service.hpp"

#include <chrono>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/navigation/drawn_limits.hpp"
#include "topogeo/planning/zone_outlines.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/support/host.hpp"
#include "topogeo/support/log.hpp"
#include "topogeo/support/version.hpp"

#include "orders/order_text.hpp"
#include "orders/route_preview.hpp"
#include "routes.hpp"
#include "server/json_values.hpp"

namespace topogeo::web {
namespace {

constexpr std::chrono::milliseconds kCountsPeriod{500};
constexpr std::chrono::milliseconds kLimitsPeriod{200};  // while anybody drives by hand
constexpr int kProtocolVersion = 1;
constexpr std::int64_t kSameStop_ns = 1'000'000'000;

const ServiceRoute* route_of(const Request& request) {
  return find_route(request.post ? Method::kPost : Method::kGet, request.path);
}

}  // namespace

template <class Work>
void WebService::post(Work work) {
  service_.loop().post([alive = std::weak_ptr<bool>(alive_), work = std::move(work)] {
    if (!alive.expired()) work();
  });
}

WebService::WebService(service::Service& service, const ServerConfig& config, PageFiles files,
                       const KeptFiles& kept)
    : service_(service),
      config_(config),
      files_(std::move(files)),
      events_(hub_, kept.alarms, [this] { service_.status().fault("alarms", "not written"); }),
      audit_(kept.audit),
      foxglove_(feed_, service.setup().config.config.local_mapper.T_robot_laser),
      controls_([this](const std::string& json) {
        post([this, json] { hub_.set(Channel::kControls, json); });
      }),
      hand_(service, hub_, events_, tally_, hand_hooks(), kept.memory),
      map_(service, hub_,
           [this](const std::shared_ptr<const MapPicture>& picture) { foxglove_.take(picture); }),
      graph_(service, hub_),
      goals_(service, hub_, map_, events_),
      robot_(service, hub_, events_,
             {[this](const navigation::ScanPoints& scan) { foxglove_.take(scan); },
              [this](const msg::LivePose& pose) { foxglove_.take(pose); },
              [this](const msg::NavigatorStatus& status, const messaging::SampleInfo& info) {
                exploration_.take(status, goals_.take(status, info));
              },
              [this] { return map_.picture(); }, [this] { return health_.battery_percent(); }}),
      drive_(service, hub_, events_),
      exploration_(service, goals_, events_, robot_, [this] { return explored_floor(); }),
      health_(service, hub_, events_),
      drawing_(service, hub_, events_),
      server_(std::make_unique<Server>(config_, hub_, files_, static_cast<Backend&>(*this), tally_,
                                       feed_)),
      localizer_(service) {
  service_.subscribe<msg::Odometry>(
      [this](const msg::Odometry& odometry) { foxglove_.take(odometry); });
  timer_ = service_.loop().add_timer(kCountsPeriod, [this] { report_counts(); });
  limits_timer_ = service_.loop().add_timer(kLimitsPeriod, [this] {
    if (hand_.is_held()) show_limits(false);
  });
  report_counts();
  service_.status().set_state(msg::kServiceRunning);
}

WebService::~WebService() {
  service_.loop().cancel_timer(timer_);
  service_.loop().cancel_timer(limits_timer_);
  drawing_.abandon();
  hand_.end();
}

const Route* WebService::route(Method method, std::string_view path) const {
  const ServiceRoute* found = find_route(method, path);
  return found != nullptr ? &found->route : nullptr;
}

void WebService::handle(const Request& request, Respond respond) {
  const ServiceRoute* found = route_of(request);
  if (found == nullptr) {
    respond(error_answer(404, "there is no " + request.path));
  } else if (found->route.handling == Handling::kInLoop) {
    hand_over(request, std::move(respond));
  } else {
    found->handler(*this, request, respond);
  }
}

Answer WebService::info(const Request& request) const {
  const std::string& other = service_.setup().options.map_robot;
  Json offers = Json::array();
  for (const ServiceRoute& row : service_routes()) {
    if (row.offer == Offer::kNever) continue;
    if (row.offer == Offer::kWithSimulator && !drawing_.takes_floors()) continue;
    offers.push_back(row.route.path.substr(kApi.size()));
  }
  Answer answer;
  answer.body = text_of(Json{{"protocol", kProtocolVersion},
                             {"robot_id", service_.robot_id()},
                             {"map_of", other.empty() ? service_.robot_id() : other},
                             {"version", support::kVersion},
                             {"life", config_.life},
                             {"may_write", request.authorized},
                             {"offers", std::move(offers)}});
  return answer;
}

void WebService::hand_over(Request request, Respond respond) {
  if (requests_.push(std::move(request), std::move(respond))) {
    post([this] { work_off_requests(); });
  }
}

void WebService::stop(const std::string& page, Respond respond) {
  hand_.stop(std::move(respond));
  Request cancel{true, std::string(kCancelPath), {}, R"({"keep":true})", true, stops(), page};
  cancel.of_stop = true;
  hand_over(std::move(cancel), [](const Answer&) {});
}

// Queued after the cancel of its stop, so that a released robot has no goal from before.
void WebService::release_stop(const std::string& page, Respond respond) {
  hand_over({true, std::string(kReleasePath), {}, "{}", true, stops(), page}, std::move(respond));
}

std::uint32_t WebService::enter(std::uint64_t viewer, const std::string& page,
                                const std::string& name) {
  return controls_.enter(viewer, page, name);
}

void WebService::leave(std::uint64_t viewer) {
  controls_.leave(viewer);
}

void WebService::drive(std::uint64_t viewer, double linear_mps, double angular_radps) {
  if (controls_.admit(viewer)) {
    hand_.drive(viewer, {linear_mps, angular_radps});
  } else {
    tally_.add("refused: no controls");
  }
}

void WebService::release(std::uint64_t viewer) {
  hand_.release(viewer);
}

ManualDriveSender::Hooks WebService::hand_hooks() {
  return {[this] {
            post([this] {
              goals_.pause();
              show_limits(true);
              const std::string driver = controls_.holder();
              if (!driver.empty()) {
                events_.add(EventLog::Level::kInfo, "operator", driver + ": drives by hand");
              }
            });
          },
          [this](const char* message) {
            post([this, message] { service_.status().fault("send blocked", message); });
          }};
}

// `anew`: even unchanged limits.
void WebService::show_limits(bool anew) {
  std::shared_ptr<const planning::HybridMap> map;
  try {
    map = map_.map();
  } catch (const std::invalid_argument& error) {
    service_.status().fault("invalid hybrid map", error.what());
  }
  if (map && map != limits_of_) {
    limits_ = std::make_shared<const navigation::DrawnLimits>(map->space());
    limits_of_ = std::move(map);
    anew = true;
  }
  if (anew) hand_.keep_off(limits_);
}

void WebService::work_off_requests() {
  const RequestQueue::Turn turn = requests_.take();
  if (turn.more) post([this] { work_off_requests(); });
  for (const auto& [request, respond] : turn.requests) {
    try {
      answer(request, respond);
    } catch (const std::invalid_argument& error) {
      tally_.add("refused: invalid");
      respond(error_answer(400, error.what()));
    }
  }
}

void WebService::answer(const Request& request, const Respond& respond) {
  const ServiceRoute* found = route_of(request);
  // The cancel of the stop may have overtaken it.
  if (found->after_stop == AfterStop::kRefused && request.stops != stops()) {
    respond(error_answer(409, "the robot was stopped meanwhile"));
    return;
  }
  if (found->route.needs_controls && !request.of_stop && !controls_.admit(request.page)) {
    tally_.add("refused: no controls");
    respond(error_answer(409, controls_.refusal()));
    return;
  }
  if (request.post) {
    tally_.add("orders");
    record(request, found->route);
  }
  found->handler(*this, request, respond);
}

// Previews and outlines of rooms order nothing.
void WebService::record(const Request& request, const Route& route) {
  if (route.access != Access::kOperator || route.path == "/api/preview") return;
  const std::string who = controls_.name_of(request.page);
  const std::string_view order = request.of_stop ? kStopPath : route.path;
  if (request.of_stop) controls_.set_stopped_by(who);
  if (route.path == kReleasePath) controls_.set_stopped_by({});
  // A page sends its stop through two connections.
  const std::int64_t now_ns = support::wall_clock_ns();
  const bool again = request.of_stop && who == stopper_ && now_ns - stopped_ns_ < kSameStop_ns;
  if (request.of_stop) {
    stopper_ = who;
    stopped_ns_ = now_ns;
  }
  if (again) return;
  if (route.needs_controls) {
    const std::string_view what =
        request.of_stop ? std::string_view("stops and holds the robot") : route.help;
    events_.add(request.of_stop ? EventLog::Level::kWarning : EventLog::Level::kInfo, "operator",
                who + ": " + std::string(what));
  }
  if (!audit_.add(now_ns, who, std::string(order),
                  request.of_stop ? std::string() : request.body)) {
    service_.status().fault("audit log", "an order could not be written to the audit log");
  }
}

Answer WebService::change_controls(const Request& request) {
  using Kind = ControlsOrder::Kind;
  const ControlsOrder order = parse_controls_order(request.body);
  const std::string who = controls_.name_of(request.page);
  const std::string before = controls_.holder();
  switch (order.kind) {
    case Kind::kAsk:
      controls_.ask(request.page);
      break;
    case Kind::kTake:
      // The page that had them may be driving by hand.
      for (const std::uint64_t viewer : controls_.take(request.page)) hand_.release(viewer);
      events_.add(EventLog::Level::kWarning, "operator",
                  who + ": takes the controls" + (before.empty() ? "" : " from " + before));
      break;
    case Kind::kGive:
    case Kind::kKeep:
      controls_.answer(request.page, order.kind == Kind::kGive);
      break;
    case Kind::kLetGo:
      controls_.let_go(request.page);
      break;
    case Kind::kRename:
      controls_.rename(request.page, order.name);
      break;
  }
  return {202, "{}"};
}

void WebService::cancel() {
  exploration_.stop();
  goals_.cancel();
}

void WebService::interrupt() {
  goals_.interrupt();
  exploration_.stop();
}

Answer WebService::resume() {
  if (goals_.was_exploring()) return exploration_.start();
  try {
    if (goals_.has_interrupted()) {
      goals_.resume_interrupted();
    } else {
      goals_.resume();
    }
  } catch (const std::invalid_argument& error) {
    return error_answer(409, error.what());
  }
  return {202, "{}"};
}

ExploredFloor WebService::explored_floor() {
  return {graph_.map(), map_.map(), [this] { return drive_.T_map_stops(); }};
}

Answer WebService::give_goals(const std::string& body) {
  return give(parse_goals(body));
}

Answer WebService::give(const GoalOrders& orders) {
  std::uint64_t id = 0;
  try {
    id = goals_.add(orders);
    exploration_.stop();
  } catch (const std::invalid_argument& error) {  // an unknown name, or no navigator
    return error_answer(409, error.what());
  }
  return {202, text_of(Json{{"goal_id", std::to_string(id)}, {"waiting", goals_.waiting()}})};
}

Answer WebService::go_back() {
  WantedGoal goal;
  // The drawing of an earlier version may name the home "base".
  for (const char* name : {"base", "base station", "home"}) {
    if (const auto found = map_.find(name); found && found->place) goal.name = found->name;
  }
  if (goal.name.empty()) goal.point_m = Eigen::Vector2d(0.0, 0.0);  // the origin of the map
  return give(GoalOrders{{goal}, false});
}

Answer WebService::preview(const std::string& body) {
  const GoalOrders orders = parse_goals(body);
  const auto& pose = robot_.pose();
  if (!pose || (pose->state() != msg::kStateTracking && pose->state() != msg::kStateAmbiguous)) {
    return error_answer(409, "the robot does not know its position");
  }
  std::shared_ptr<const planning::HybridMap> map;
  std::shared_ptr<const topomap::GlobalMap> graph;
  std::vector<Eigen::Vector2d> goals_m;
  try {
    map = map_.map();
    graph = graph_.map();
    for (const WantedGoal& goal : orders.goals) goals_m.push_back(goals_.position_of(goal));
  } catch (const std::invalid_argument& error) {
    return error_answer(409, error.what());
  }
  const planning::PlanningMaps maps{map.get(), graph.get()};
  if (!maps.any()) return error_answer(409, "there is no map to plan on yet");
  const pipeline::Config& config = service_.setup().config.config;
  return preview_route(maps, service::from_msg(pose->T_map_robot()), goals_m,
                       {config.planner, config.hybrid_planner, config.planning}, config.navigator);
}

// Goals on another floor are meaningless.
void WebService::load_floor(const std::string& body, const Respond& respond) {
  drawing_.load_floor(body, [this, respond](Answer answer) {
    if (answer.status < 300) cancel();
    respond(std::move(answer));
  });
}

Answer WebService::room_shapes(const std::string& body) {
  const ShapesOrder order = parse_shapes_order(body);
  const std::shared_ptr<const planning::HybridMap> map = map_.map();
  if (!map) return error_answer(409, "there is no map yet");
  for (const planning::ZoneId zone : order.zones) {
    if (zone >= map->zones().zones.size()) {
      return error_answer(409, "there is no zone " + std::to_string(zone) + " any more");
    }
  }
  Json shapes = Json::array();
  for (const auto& outline_m :
       planning::outlines_of(map->frame(), map->zones(), order.zones, order.cut_m)) {
    Json corners = Json::array();
    for (const Eigen::Vector2d& corner_m : outline_m) {
      corners.push_back(rounded(corner_m.x()));
      corners.push_back(rounded(corner_m.y()));
    }
    shapes.push_back({{"corners_m", std::move(corners)}});
  }
  return {200, text_of(Json{{"shapes", std::move(shapes)}})};
}

void WebService::report_counts() {
  messaging::StatusPublisher& status = service_.status();
  for (const auto& [name, count] : tally_.counts()) {
    if (name.starts_with("refused: ")) {
      status.set_drops(name, count);
    } else {
      status.set_counter(name, static_cast<double>(count));
    }
  }
}

}  // namespace topogeo::web
