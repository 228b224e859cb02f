#include "orders/localizer_requests.hpp"

#include <optional>
#include <utility>

#include "topogeo/messaging/message.hpp"
#include "topogeo/session/slam_session.hpp"
#include "topogeo/support/host.hpp"

#include "server/json_values.hpp"

namespace topogeo::web {
namespace {

constexpr double kRequestPatience_s = 5.0;

}  // namespace

LocalizerRequests::LocalizerRequests(service::Service& service)
    : service_(service),
      client_id_(support::process_name()),
      pending_(service, "no localizer has answered", kRequestPatience_s),
      commands_(service.advertise<msg::LocalizationCommand>()),
      answers_(service.advertise<msg::MergeAnswer>()) {
  // A localizer of several robots replies under the name of the map.
  service.subscribe<msg::LocalizationReply>(
      [this](const msg::LocalizationReply& reply) { on_reply(reply); }, {.any_robot = true});
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
  pending_.begin(std::move(respond), [this, command](std::uint64_t id) mutable {
    command.request_id = id;
    const auto message =
        service::to_msg(command, service_.robot_id(), support::wall_clock_ns(), sent_++);
    static_cast<void>(commands_.write(message));
  });
}

void LocalizerRequests::answer_merge(const MergeOrder& order, Respond respond) {
  const std::string& other = service_.setup().options.map_robot;
  msg::MergeAnswer answer;
  messaging::set_header(answer, other.empty() ? service_.robot_id() : other,
                        support::wall_clock_ns(), sent_++);
  messaging::set_client_id(answer, client_id_);
  answer.number(order.number);
  answer.accepted(order.accept);
  pending_.begin(std::move(respond), [this, answer](std::uint64_t id) mutable {
    answer.request_id(id);
    static_cast<void>(answers_.write(answer));
  });
}

void LocalizerRequests::on_reply(const msg::LocalizationReply& reply) {
  if (reply.client_id() != client_id_.c_str()) return;
  const std::optional<Respond> respond = pending_.take(reply.request_id());
  if (!respond) return;
  const std::string message = text_of_message(reply.message());
  if (reply.accepted()) {
    (*respond)({200, text_of(Json{{"accepted", true}, {"message", message}})});
  } else {
    (*respond)(error_answer(409, message.empty() ? "the localizer refuses" : message));
  }
}

}  // namespace topogeo::web
