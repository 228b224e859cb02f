// Replies of the localizer to commands and answers. A client without a reply repeats its request,
// so a repeated request is not carried out again; only its reply is repeated.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <utility>

#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/trajectory.h"
#include "topogeo/service/service.hpp"

#include "localizer_commands.hpp"

namespace topogeo::localizer {

class ReplySender {
 public:
  /// Throws like Writer.
  explicit ReplySender(service::Service& service)
      : service_(service), replies_(service.advertise<msg::LocalizationReply>()) {}

  /// True when that client sent a request of that number before; repeats the reply if there is one.
  bool came_before(std::uint64_t request_id, const std::string& client_id);
  /// Replies to that request and counts it. `stamp_ns` is the stamp of the last stop.
  void reply(std::uint64_t request_id, const std::string& client_id, const CommandAnswer& answer,
             std::int64_t stamp_ns);

 private:
  service::Service& service_;
  messaging::Writer<msg::LocalizationReply> replies_;
  std::deque<msg::LocalizationReply> newest_;
  std::deque<std::pair<std::uint64_t, std::string>> pending_;  // without a reply yet
  std::uint64_t sent_ = 0;
};

}  // namespace topogeo::localizer
