// Requests of pages to another service, handled in the loop of this one.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "topogeo/service/service.hpp"

#include "orders/request_table.hpp"

namespace topogeo::web {

/// A RequestTable with its clock and CPU watch. Lives in the loop of its service.
class PendingRequests {
 public:
  /// See RequestTable. The other service carries out a request once and repeats its reply.
  PendingRequests(service::Service& service, std::string none, double patience_s);
  PendingRequests(const PendingRequests&) = delete;
  PendingRequests& operator=(const PendingRequests&) = delete;
  ~PendingRequests();

  /// Sends a request under a new number: calls `send` with it, perhaps several times. `heard`: see
  /// RequestTable.
  void begin(Respond respond, std::function<void(std::uint64_t id)> send,
             std::function<bool()> heard = {});
  /// The handler for the reply to a request; nothing when it was already answered.
  std::optional<Respond> take(std::uint64_t id) { return table_.take(id); }

 private:
  service::Service& service_;
  RequestTable table_;
  std::uint64_t timer_ = 0;
};

}  // namespace topogeo::web
