// A map cut into pieces that fit into messages, and put together again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/msg/store.h"

namespace topogeo::service {

/// Client id of pieces for the map store (msg::kArchiveImport).
inline constexpr const char* kArchiveAddressee = "archive";

/// How many pieces so many bytes make, 1 at least: none stands for no answer.
std::uint32_t piece_count(std::size_t bytes);

/// Sets number, count and bytes of piece `number` of `bytes`.
void cut_piece(msg::SnapshotPiece& piece, std::string_view bytes, std::uint32_t number);

/// Pieces of one answer, in any order.
class PieceAssembly {
 public:
  /// The first piece makes room for all: it may be one of `most`.
  explicit PieceAssembly(std::uint32_t most) : most_(most) {}

  /// Throws std::invalid_argument for a piece of another count than those before, of more than
  /// `most`, or beyond its own count.
  void add(const msg::SnapshotPiece& piece);
  [[nodiscard]] bool empty() const { return pieces_.empty(); }
  [[nodiscard]] bool complete() const;
  /// All bytes of a complete answer; nothing is left here.
  [[nodiscard]] std::string take();
  void clear() { pieces_.clear(); }

 private:
  std::uint32_t most_;
  std::vector<std::optional<std::string>> pieces_;
};

}  // namespace topogeo::service
