// Requests of pages to another service: sent again until its reply comes, given up in time.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "topogeo/service/service.hpp"

#include "server/web_types.hpp"

namespace topogeo::web {

/// Lives in the loop of its service.
class PendingRequests {
 public:
  /// `none`: the error, with status 503, where no reply has come after `patience_s`, or after six
  /// times as long while this machine is too busy, which the error then names. A time in which this
  /// service did not run does not count. The other service carries out a request once and repeats
  /// its reply.
  PendingRequests(service::Service& service, std::string none, double patience_s);
  PendingRequests(const PendingRequests&) = delete;
  PendingRequests& operator=(const PendingRequests&) = delete;
  ~PendingRequests();

  /// Sends a request under a number of its own: `send` is called with it, perhaps several times.
  /// While `heard` returns true the other service is there, busy perhaps, and the request waits for
  /// its reply up to a minute: the operator must not hear that nobody answers and then see the
  /// order carried out.
  void begin(Respond respond, std::function<void(std::uint64_t id)> send,
             std::function<bool()> heard = {});
  /// Who gets the reply to a request; nothing where it was answered.
  std::optional<Respond> take(std::uint64_t id);

 private:
  struct Pending {
    Respond respond;
    std::function<void(std::uint64_t id)> send;
    std::function<bool()> heard;
    double waited_s = 0.0;
    double sent_s = 0.0;  // by the steady clock
  };
  void tick();

  service::Service& service_;
  std::string none_;
  double patience_s_;
  double last_tick_s_;
  std::uint64_t last_id_;
  std::uint64_t timer_ = 0;
  std::map<std::uint64_t, Pending> pending_;
};

}  // namespace topogeo::web
