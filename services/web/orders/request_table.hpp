// Requests that wait for a reply: repeated until it comes, given up in time. Has no clock.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "topogeo/support/patience.hpp"

#include "server/web_types.hpp"

namespace topogeo::web {

/// The caller passes the time, in seconds from any start. Time in which this process did not run is
/// not counted, because replies may be unread.
class RequestTable {
 public:
  /// A request is repeated after this time without a reply.
  static constexpr double kSendAgain_s = 1.0;
  /// Patience with a service that is heard: it answers late, not never, and could otherwise carry
  /// out an order after the operator was told that it does not answer.
  static constexpr double kHeard_s = 60.0;
  /// Longest time between two calls of tick() that counts in full.
  static constexpr double kLongestTick_s = 0.5;

  /// `none`: the error, with status 503, when no reply has come after `patience_s`. Time in which
  /// this machine is too busy counts by support::PatienceClock::kBusyRate, and the error names it.
  /// `first_id`: the ids follow this one.
  RequestTable(std::string none, double patience_s, double now_s, std::uint64_t first_id);

  /// Calls `send` with the id of the request, now and repeatedly until take(id). `heard`: whether
  /// the other service is there, perhaps busy; empty: unknown.
  void begin(Respond respond, std::function<void(std::uint64_t id)> send,
             std::function<bool()> heard, double now_s);
  /// The handler for the reply to a request; nothing when it was answered or given up.
  std::optional<Respond> take(std::uint64_t id);
  /// Call it several times in kLongestTick_s. `busy`: why this machine is too busy; empty when it
  /// is not.
  void tick(double now_s, const std::string& busy);

 private:
  struct Pending {
    Respond respond;
    std::function<void(std::uint64_t id)> send;
    std::function<bool()> heard;
    double since_s = 0.0;  // by the patience clock
    double sent_s = 0.0;   // by the caller's clock
    std::string busy;      // last reason why this machine was too busy while the request waited
  };
  [[nodiscard]] bool is_hopeless(const Pending& request) const;

  std::string none_;
  double patience_s_;
  support::PatienceClock clock_;
  std::uint64_t last_id_;
  std::map<std::uint64_t, Pending> pending_;
};

}  // namespace topogeo::web
