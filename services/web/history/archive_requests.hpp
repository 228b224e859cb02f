// Requests to the map store for snapshots and for maps to become snapshots, and its replies.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/archive.h"
#include "topogeo/msg/store.h"
#include "topogeo/service/service.hpp"

#include "orders/pending_requests.hpp"
#include "server/web_types.hpp"

namespace topogeo::web {

/// Lives in the loop of its service. Each function answers once: 200 with the snapshots by time,
/// 409 when the map store refuses, 503 when none replies in time.
class ArchiveRequests {
 public:
  explicit ArchiveRequests(service::Service& service);
  ArchiveRequests(const ArchiveRequests&) = delete;
  ArchiveRequests& operator=(const ArchiveRequests&) = delete;
  ~ArchiveRequests();

  void list(Respond respond);
  /// These throw std::invalid_argument for an invalid snapshot name.
  void take(const std::string& name, Respond respond);
  void restore(const std::string& name, Respond respond);
  void remove(const std::string& name, Respond respond);
  /// Both names together have at most 63 characters.
  void rename(const std::string& name, const std::string& new_name, Respond respond);
  /// Makes a snapshot from a map file. One at a time: 503 while another is being sent.
  void import(const std::string& name, std::string map_file, Respond respond);

 private:
  void send(msg::ArchiveAction action, const std::string& name, Respond respond);
  void on_reply(const msg::ArchiveReply& reply);
  [[nodiscard]] const std::string& map_robot() const;
  void send_pieces();

  service::Service& service_;
  std::string client_id_;
  std::uint64_t sent_ = 0;
  PendingRequests pending_;
  messaging::Writer<msg::ArchiveRequest> requests_;
  messaging::Writer<msg::SnapshotPiece> pieces_;
  std::string map_file_;  // the one being sent
  std::uint64_t import_request_ = 0;
  std::uint32_t next_piece_ = 0;
  std::uint64_t pieces_sent_ = 0;
  std::optional<std::uint64_t> timer_;  // runs while one is sent
};

}  // namespace topogeo::web
