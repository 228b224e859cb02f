#include "localizer_requests.hpp"

#include <chrono>
#include <memory>
#include <random>
#include <utility>

#include "topogeo/localization/session/slam_session.hpp"
#include "topogeo/messaging/message.hpp"
#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/host.hpp"

#include "json_values.hpp"

namespace topogeo::web {
namespace {

constexpr std::chrono::milliseconds kRequestTick{100};
constexpr double kSendAgain_s =
    1.0;  // the localizer carries out a request once and repeats its reply
constexpr double kRequestPatience_s = 5.0;

}  // namespace

LocalizerRequests::LocalizerRequests(service::Service& service)
    : service_(service),
      client_id_(support::process_name()),
      last_id_(std::uint64_t{std::random_device{}()} << 16U),
      commands_(service.advertise<msg::LocalizationCommand>()),
      answers_(service.advertise<msg::MergeAnswer>()) {
  // A localizer of several robots answers under the name of the map.
  service.subscribe<msg::LocalizationReply>(
      [this](const msg::LocalizationReply& reply) { on_reply(reply); }, {.any_robot = true});
  service.loop().add_timer(kRequestTick, [this] { tick(); });
}

std::uint64_t LocalizerRequests::new_id() {
  return ++last_id_;
}

void LocalizerRequests::set_pose(const PoseOrder& order, Respond respond) {
  service::LocalizationCommand command;
  command.kind = msg::kCommandSetPose;
  command.T_map_robot = order.T_map_robot;
  command.covariance = localization::given_pose_covariance();
  if (order.sigma_m) {
    command.covariance(0, 0) = command.covariance(1, 1) = *order.sigma_m * *order.sigma_m;
  }
  if (order.sigma_rad) command.covariance(2, 2) = *order.sigma_rad * *order.sigma_rad;
  send(std::move(command), std::move(respond));
}

void LocalizerRequests::search(Respond respond) {
  service::LocalizationCommand command;
  command.kind = msg::kCommandSearch;
  send(std::move(command), std::move(respond));
}

void LocalizerRequests::switch_mode(bool mapping, Respond respond) {
  service::LocalizationCommand command;
  command.kind = mapping ? msg::kCommandSwitchToMapping : msg::kCommandSwitchToLocalization;
  send(std::move(command), std::move(respond));
}

void LocalizerRequests::send(service::LocalizationCommand command, Respond respond) {
  command.client_id = client_id_;
  command.request_id = new_id();
  begin(command.request_id, {std::move(respond), [this, command] {
                               const auto message = service::to_msg(
                                   command, service_.robot_id(), support::wall_clock_ns(), sent_++);
                               static_cast<void>(commands_.write(message));
                             }});
}

void LocalizerRequests::answer_merge(const MergeOrder& order, Respond respond) {
  const std::string& other = service_.setup().options.map_robot;
  msg::MergeAnswer answer;
  messaging::set_header(answer, other.empty() ? service_.robot_id() : other,
                        support::wall_clock_ns(), sent_++);
  messaging::set_client_id(answer, client_id_);
  answer.request_id(new_id());
  answer.number(order.number);
  answer.accepted(order.accept);
  begin(answer.request_id(),
        {std::move(respond), [this, answer] { static_cast<void>(answers_.write(answer)); }});
}

void LocalizerRequests::begin(std::uint64_t id, Pending pending) {
  pending.since_s = pending.sent_s = support::monotonic_s();
  pending.send();
  pending_.emplace(id, std::move(pending));
}

void LocalizerRequests::on_reply(const msg::LocalizationReply& reply) {
  if (reply.client_id() != client_id_.c_str()) return;
  const auto found = pending_.find(reply.request_id());
  if (found == pending_.end()) return;
  const Respond respond = std::move(found->second.respond);
  pending_.erase(found);
  const std::string message = text_of_message(reply.message());
  if (reply.accepted()) {
    respond({200, text_of(Json{{"accepted", true}, {"message", message}})});
  } else {
    respond(error_answer(409, message.empty() ? "the localizer refuses" : message));
  }
}

void LocalizerRequests::tick() {
  const double now_s = support::monotonic_s();
  for (auto pending = pending_.begin(); pending != pending_.end();) {
    Pending& request = pending->second;
    if (now_s - request.since_s > kRequestPatience_s) {
      request.respond(error_answer(503, "no localizer has answered"));
      pending = pending_.erase(pending);
      continue;
    }
    if (now_s - request.sent_s > kSendAgain_s) {
      request.sent_s = now_s;
      request.send();
    }
    ++pending;
  }
}

}  // namespace topogeo::web
