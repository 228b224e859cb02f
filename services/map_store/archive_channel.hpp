// Snapshots of the map for those who ask over DDS: listed, made and imported here, restored by the
// program, which has to let go of the database first.
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
  /// Called before a snapshot is made, so that all that has come is in it. Throws
  /// std::runtime_error.
  using Store = std::function<void()>;
  /// Called after the reply to a request to restore: the program is to do it.
  using Restore = std::function<void(const std::string& name)>;

  /// An empty `database`: there is none, and every request is refused. Throws like Reader and
  /// Writer.
  ArchiveChannel(service::Service& service, std::filesystem::path database, Store store,
                 Restore restore);

  /// Of the snapshot with that StoredSnapshot::name_key. Throws std::runtime_error when there is
  /// none.
  [[nodiscard]] std::filesystem::path path_of(std::uint64_t name_key) const;

 private:
  void on_request(const msg::ArchiveRequest& request);
  /// What was done, as a sentence. Throws std::exception saying why not.
  std::string carry_out(const msg::ArchiveRequest& request);
  void on_piece(const msg::SnapshotPiece& piece);

  service::Service& service_;
  std::filesystem::path database_;
  Store store_;
  Restore restore_;
  messaging::Writer<msg::ArchiveReply> replies_;
  std::optional<msg::ArchiveReply> last_;  // who gets none sends the request again
  service::PieceAssembly imported_{msg::kMaxImportedPieces};
  std::uint64_t import_request_ = 0;  // that the pieces are of
  std::uint64_t sent_ = 0;
};

}  // namespace topogeo::map_store
