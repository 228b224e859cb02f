#include "topogeo/service/snapshot_pieces.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "topogeo/support/format.hpp"

namespace topogeo::service {

std::uint32_t piece_count(std::size_t bytes) {
  const std::size_t pieces = (bytes + msg::kMaxPieceBytes - 1) / msg::kMaxPieceBytes;
  return static_cast<std::uint32_t>(std::max<std::size_t>(pieces, 1));
}

void cut_piece(msg::SnapshotPiece& piece, std::string_view bytes, std::uint32_t number) {
  piece.piece(number);
  piece.pieces(piece_count(bytes.size()));
  const std::size_t begin = std::size_t{number} * msg::kMaxPieceBytes;
  const std::string_view part = bytes.substr(std::min(begin, bytes.size()), msg::kMaxPieceBytes);
  piece.bytes().assign(part.begin(), part.end());
}

void PieceAssembly::add(const msg::SnapshotPiece& piece) {
  const bool other_answer = !pieces_.empty() && piece.pieces() != pieces_.size();
  if (piece.pieces() > most_ || other_answer) {
    throw std::invalid_argument(fmt::format(
        "{} pieces, expected {}", piece.pieces(),
        other_answer ? std::to_string(pieces_.size()) : fmt::format("at most {}", most_)));
  }
  if (piece.piece() >= piece.pieces()) {
    throw std::invalid_argument(
        fmt::format("number {} of {} pieces", piece.piece(), piece.pieces()));
  }
  pieces_.resize(piece.pieces());
  pieces_[piece.piece()] = std::string(piece.bytes().begin(), piece.bytes().end());
}

bool PieceAssembly::complete() const {
  const auto here = [](const std::optional<std::string>& part) { return part.has_value(); };
  return !pieces_.empty() && std::ranges::all_of(pieces_, here);
}

std::string PieceAssembly::take() {
  std::string bytes;
  for (const std::optional<std::string>& part : pieces_) bytes += part.value();
  pieces_.clear();
  return bytes;
}

}  // namespace topogeo::service
