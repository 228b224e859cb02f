// Queries the map store for a starting service: the stored state, and snapshots of it.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/store.h"
#include "topogeo/service/service.hpp"
#include "topogeo/service/snapshot_pieces.hpp"

namespace topogeo::service {

/// Lives in the loop of its service.
class StoreClient {
 public:
  /// `on_stored` is called for every message of the store.
  StoreClient(Service& service, std::function<void(const msg::StoredMap&)> on_stored);
  ~StoreClient();
  StoreClient(const StoreClient&) = delete;
  StoreClient& operator=(const StoreClient&) = delete;

  /// The bytes, in the format of the SnapshotKind, or why there are none.
  struct Answer {
    std::optional<std::string> bytes;
    std::string why;
  };
  using Handler = std::function<void(Answer answer)>;

  /// Repeats the request while the store does not answer: it may be starting. Only one request is
  /// active; a second one replaces it.
  void request(msg::SnapshotKind kind, std::uint64_t session, std::uint32_t first, Handler handler);

 private:
  /// `anew`: under a new number, so that pieces of an earlier answer are not mixed in.
  void send(bool anew);
  void on_piece(const msg::SnapshotPiece& piece);
  void tick();

  using Clock = std::chrono::steady_clock;
  static constexpr std::uint32_t kMostPieces = 32'768;  // 1.8 GB

  Service& service_;
  std::string client_id_;
  messaging::Writer<msg::SnapshotRequest> requests_;
  std::uint64_t requests_sent_ = 0;
  std::optional<msg::SnapshotRequest> request_;
  Handler handler_;
  PieceAssembly pieces_{kMostPieces};  // of the answer
  Clock::time_point last_heard_;
  bool heard_by_nobody_ = false;  // the store was not known when the request was sent
  std::uint64_t timer_ = 0;
};

}  // namespace topogeo::service
