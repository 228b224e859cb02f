// Replies of the localizer to commands and answers. Who gets none sends its request again, so a
// request that came already is carried out once, and its reply repeated.
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

  /// True when a request of that number and client came before; sends its reply again if it has
  /// one.
  bool came_before(std::uint64_t request_id, const std::string& client_id);
  /// To the request of that number and client; counts it. `stamp_ns` is that of the last stop.
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
