// Splits a map into pieces that fit into messages, and joins them again.
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

/// Number of pieces for `bytes` bytes, at least 1, because 0 pieces mean no answer.
std::uint32_t piece_count(std::size_t bytes);

/// Sets number, count and bytes of piece `number` of `bytes`.
void cut_piece(msg::SnapshotPiece& piece, std::string_view bytes, std::uint32_t number);

/// Pieces of one answer, in any order.
class PieceAssembly {
 public:
  /// The first piece allocates room for all of them, at most `most` pieces.
  explicit PieceAssembly(std::uint32_t most) : most_(most) {}

  /// Throws std::invalid_argument for a piece whose count differs from the ones before or exceeds
  /// `most`, or whose number exceeds its own count.
  void add(const msg::SnapshotPiece& piece);
  [[nodiscard]] bool empty() const { return pieces_.empty(); }
  [[nodiscard]] bool complete() const;
  /// Returns all bytes of a complete answer and clears the assembly.
  [[nodiscard]] std::string take();
  void clear() { pieces_.clear(); }

 private:
  std::uint32_t most_;
  std::vector<std::optional<std::string>> pieces_;
};

}  // namespace topogeo::service
