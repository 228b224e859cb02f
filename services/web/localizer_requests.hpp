// Requests to the localizer and its replies.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>

#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/merge.h"
#include "topogeo/msg/trajectory.h"
#include "topogeo/service/conversions.hpp"
#include "topogeo/service/service.hpp"

#include "order_text.hpp"
#include "web_types.hpp"

namespace topogeo::web {

/// Lives in the loop of its service. Each function answers once: 200 with accepted and message, 409
/// where the localizer refuses, 503 where none replies within five seconds.
class LocalizerRequests {
 public:
  explicit LocalizerRequests(service::Service& service);

  void set_pose(const PoseOrder& order, Respond respond);
  void search(Respond respond);
  void switch_mode(bool mapping, Respond respond);
  void answer_merge(const MergeOrder& order, Respond respond);

 private:
  struct Pending {
    Respond respond;
    std::function<void()> send;
    double since_s = 0.0;  // by the steady clock
    double sent_s = 0.0;
  };

  void send(service::LocalizationCommand command, Respond respond);
  void begin(std::uint64_t id, Pending pending);
  void on_reply(const msg::LocalizationReply& reply);
  void tick();
  [[nodiscard]] std::uint64_t new_id();

  service::Service& service_;
  std::string client_id_;
  std::uint64_t last_id_;
  std::uint64_t sent_ = 0;
  std::map<std::uint64_t, Pending> pending_;
  messaging::Writer<msg::LocalizationCommand> commands_;
  messaging::Writer<msg::MergeAnswer> answers_;
};

}  // namespace topogeo::web
