// Handles snapshot requests over DDS: lists, makes and imports them here; the program restores
// them, because it has to release the database first.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/archive.h"
#include "topogeo/msg/store.h"
#include "topogeo/service/service.hpp"
#include "topogeo/service/snapshot_pieces.hpp"
#include "topogeo/storage/map_snapshots.hpp"

namespace topogeo::map_store {

/// Lives in the loop of its service.
class ArchiveChannel {
 public:
  /// Called before a snapshot is made, so that the snapshot contains everything received. Throws
  /// std::runtime_error.
  using Store = std::function<void()>;
  /// Called after the reply to a restore request: the program then restores the snapshot.
  using Restore = std::function<void(const std::string& name)>;

  /// An empty `database` means that there is none and every request is refused. Throws like Reader
  /// and Writer.
  ArchiveChannel(service::Service& service, std::filesystem::path database, Store store,
                 Restore restore);

  /// File of the snapshot with that StoredSnapshot::name_key. Throws std::runtime_error when there
  /// is none.
  [[nodiscard]] std::filesystem::path path_of(std::uint64_t name_key) const;

 private:
  void on_request(const msg::ArchiveRequest& request);
  /// Returns the action taken, as a sentence. Throws std::exception with the reason for a refusal.
  std::string carry_out(const msg::ArchiveRequest& request);
  void on_piece(const msg::SnapshotPiece& piece);

  service::Service& service_;
  std::filesystem::path database_;
  Store store_;
  Restore restore_;
  messaging::Writer<msg::ArchiveReply> replies_;
  std::optional<msg::ArchiveReply> last_;  // a client without a reply repeats its request
  service::PieceAssembly imported_{msg::kMaxImportedPieces};
  std::uint64_t import_request_ = 0;  // to which the pieces belong
  std::uint64_t sent_ = 0;
};

}  // namespace topogeo::map_store
