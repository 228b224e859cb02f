// Requests of pages to another service, in the loop of this one.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "topogeo/service/service.hpp"

#include "orders/request_table.hpp"

namespace topogeo::web {

/// The clock and the CPU watch of a RequestTable. Lives in the loop of its service.
class PendingRequests {
 public:
  /// See RequestTable. The other service carries out a request once and repeats its reply.
  PendingRequests(service::Service& service, std::string none, double patience_s);
  PendingRequests(const PendingRequests&) = delete;
  PendingRequests& operator=(const PendingRequests&) = delete;
  ~PendingRequests();

  /// Sends a request under a number of its own: `send` is called with it, perhaps several times.
  /// `heard`: see RequestTable.
  void begin(Respond respond, std::function<void(std::uint64_t id)> send,
             std::function<bool()> heard = {});
  /// The handler of the reply to a request; nothing where it was answered.
  std::optional<Respond> take(std::uint64_t id) { return table_.take(id); }

 private:
  service::Service& service_;
  RequestTable table_;
  std::uint64_t timer_ = 0;
};

}  // namespace topogeo::web
