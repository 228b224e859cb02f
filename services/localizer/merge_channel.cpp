#include "merge_channel.hpp"

#include <algorithm>
#include <utility>

#include "topogeo/messaging/message.hpp"
#include "topogeo/service/merge_conversions.hpp"

namespace topogeo::localizer {

MergeChannel::MergeChannel(service::Service& service, std::function<void()> on_arrival)
    : service_(service),
      on_arrival_(std::move(on_arrival)),
      proposals_(service.advertise<msg::MergeProposal>()),
      replies_(service) {
  service.subscribe<msg::MergeAnswer>([this](const msg::MergeAnswer& answer) {
    if (replies_.came_before(answer.request_id(), answer.client_id().to_string())) return;
    waiting_.push_back(answer);
    on_arrival_();
  });
  service.subscribe<msg::LocalizationCommand>([this](const msg::LocalizationCommand& command) {
    if (replies_.came_before(command.request_id(), command.client_id().to_string())) return;
    replies_.reply(command.request_id(), command.client_id().to_string(),
                   {false, "a localizer of several robots does not support this command"}, 0);
  });
}

void MergeChannel::publish(const std::vector<localization::MergeProposal>& proposals,
                           std::int64_t stamp_ns) {
  for (const localization::MergeProposal& proposal : proposals) {
    msg::MergeProposal message = service::to_msg(proposal, service_.robot_id(), 0, 0);
    const auto before = std::ranges::find_if(
        sent_, [&](const msg::MergeProposal& held) { return held.number() == message.number(); });
    if (before != sent_.end() && *before == message) continue;
    if (before != sent_.end()) {
      *before = message;
    } else {
      sent_.push_back(message);
    }
    message.stamp_ns(stamp_ns);
    message.sequence_number(sent_count_++);
    if (!service_.send(proposals_, message, "merge proposal")) return;
  }
}

void MergeChannel::carry_out(const Handler& handler, std::int64_t stamp_ns) {
  while (!waiting_.empty()) {
    const msg::MergeAnswer answer = std::move(waiting_.front());
    waiting_.pop_front();
    replies_.reply(answer.request_id(), answer.client_id().to_string(),
                   handler(answer.number(), answer.accepted()), stamp_ns);
  }
}

}  // namespace topogeo::localizer
