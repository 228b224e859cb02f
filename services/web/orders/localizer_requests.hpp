// Requests to the localizer and its replies.
#pragma once

#include <cstdint>
#include <string>

#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/merge.h"
#include "topogeo/msg/trajectory.h"
#include "topogeo/service/conversions.hpp"
#include "topogeo/service/service.hpp"

#include "orders/order_text.hpp"
#include "orders/pending_requests.hpp"
#include "server/web_types.hpp"

namespace topogeo::web {

/// Lives in the loop of its service. Each function answers once: 200 with accepted and message, 409
/// when the localizer refuses, 503 when none replies within five seconds.
class LocalizerRequests {
 public:
  explicit LocalizerRequests(service::Service& service);

  void set_pose(const PoseOrder& order, Respond respond);
  void search(Respond respond);
  void switch_mode(bool mapping, Respond respond);
  void answer_merge(const MergeOrder& order, Respond respond);

 private:
  void send(service::LocalizationCommand command, Respond respond);
  void on_reply(const msg::LocalizationReply& reply);

  service::Service& service_;
  std::string client_id_;
  std::uint64_t sent_ = 0;
  PendingRequests pending_;
  messaging::Writer<msg::LocalizationCommand> commands_;
  messaging::Writer<msg::MergeAnswer> answers_;
};

}  // namespace topogeo::web
