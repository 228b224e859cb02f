// Requests that wait for a reply: sent again until it comes, given up in time. Has no clock.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "topogeo/support/patience.hpp"

#include "server/web_types.hpp"

namespace topogeo::web {

/// The caller passes the time, in seconds from any start. A time in which this process did not run
/// does not count: replies may be unread.
class RequestTable {
 public:
  /// A request goes out again after so long without a reply.
  static constexpr double kSendAgain_s = 1.0;
  /// Patience with a service that is heard: it answers late, not never, and would carry out the
  /// order after the operator has read that nobody answers.
  static constexpr double kHeard_s = 60.0;
  /// The longest time between two calls of tick() that counts as a whole.
  static constexpr double kLongestTick_s = 0.5;

  /// `none`: the error, with status 503, where no reply has come after `patience_s`. Time in which
  /// this machine is too busy counts by support::PatienceClock::kBusyRate, and the error names it.
  /// `first_id`: ids follow this one.
  RequestTable(std::string none, double patience_s, double now_s, std::uint64_t first_id);

  /// Calls `send` with the id of the request, now and again until take(id). `heard`: whether the
  /// other service is there, busy perhaps; empty: it is not known.
  void begin(Respond respond, std::function<void(std::uint64_t id)> send,
             std::function<bool()> heard, double now_s);
  /// The handler of the reply to a request; nothing where it was answered or given up.
  std::optional<Respond> take(std::uint64_t id);
  /// Several times in kLongestTick_s. `busy`: why this machine is too busy; empty when it is not.
  void tick(double now_s, const std::string& busy);

 private:
  struct Pending {
    Respond respond;
    std::function<void(std::uint64_t id)> send;
    std::function<bool()> heard;
    double since_s = 0.0;  // by the patience clock
    double sent_s = 0.0;   // by the caller's clock
    std::string busy;      // why this machine was too busy last while the request waited
  };
  [[nodiscard]] bool is_hopeless(const Pending& request) const;

  std::string none_;
  double patience_s_;
  support::PatienceClock clock_;
  std::uint64_t last_id_;
  std::map<std::uint64_t, Pending> pending_;
};

}  // namespace topogeo::web
