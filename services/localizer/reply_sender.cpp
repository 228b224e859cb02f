#include "reply_sender.hpp"

#include <algorithm>
#include <cstddef>

#include "topogeo/messaging/message.hpp"

namespace topogeo::localizer {

namespace {

/// Requests come from people who wait for the reply: a few at a time.
constexpr std::size_t kRemembered = 64;

}  // namespace

bool ReplySender::came_before(std::uint64_t request_id, const std::string& client_id) {
  const auto given = std::ranges::find_if(newest_, [&](const msg::LocalizationReply& reply) {
    return reply.request_id() == request_id && reply.client_id() == client_id.c_str();
  });
  if (given != newest_.end()) {
    given->sequence_number(sent_++);
    static_cast<void>(service_.send(replies_, *given, "reply"));
    return true;
  }
  const std::pair request{request_id, client_id};
  if (std::ranges::find(pending_, request) != pending_.end()) return true;
  pending_.push_back(request);
  if (pending_.size() > kRemembered) pending_.pop_front();
  return false;
}

void ReplySender::reply(std::uint64_t request_id, const std::string& client_id,
                        const CommandAnswer& answer, std::int64_t stamp_ns) {
  msg::LocalizationReply message;
  messaging::set_header(message, service_.robot_id(), stamp_ns, sent_++);
  message.request_id(request_id);
  messaging::set_text_cut(message.client_id(), client_id);
  message.accepted(answer.accepted);
  messaging::set_text_cut(message.message(), answer.message);
  service_.status().add_to_counter(answer.accepted ? "commands_accepted" : "commands_refused");
  static_cast<void>(service_.send(replies_, message, "reply"));
  std::erase(pending_, std::pair{request_id, client_id});
  newest_.push_back(message);
  if (newest_.size() > kRemembered) newest_.pop_front();
}

}  // namespace topogeo::localizer
