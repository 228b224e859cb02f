#include "topogeo/service/snapshot_pieces.hpp"

#include <algorithm>
#include <stdexcept>

#include <gtest/gtest.h>

namespace topogeo::service {
namespace {

std::vector<msg::SnapshotPiece> pieces_of(const std::string& bytes) {
  std::vector<msg::SnapshotPiece> pieces(piece_count(bytes.size()));
  for (std::uint32_t i = 0; i < pieces.size(); ++i) cut_piece(pieces[i], bytes, i);
  return pieces;
}

TEST(SnapshotPieces, AreTheSameBytesInAnyOrder) {
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{1}, std::size_t{msg::kMaxPieceBytes},
        std::size_t{msg::kMaxPieceBytes} + 1, 3 * std::size_t{msg::kMaxPieceBytes} + 17}) {
    std::string bytes(size, '\0');
    for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<char>(i % 251);
    auto pieces = pieces_of(bytes);
    EXPECT_EQ(pieces.size(), std::max<std::size_t>(1, (size + 57343) / 57344));
    std::ranges::reverse(pieces);
    PieceAssembly assembly(8);
    for (const msg::SnapshotPiece& piece : pieces) {
      EXPECT_FALSE(assembly.complete());
      assembly.add(piece);
      assembly.add(piece);  // a second time
    }
    ASSERT_TRUE(assembly.complete()) << size;
    EXPECT_TRUE(assembly.take() == bytes) << size;
    EXPECT_TRUE(assembly.empty());
  }
}

TEST(SnapshotPieces, WhatCannotBeOfOneAnswerIsRefused) {
  PieceAssembly assembly(2);
  EXPECT_FALSE(assembly.complete());
  EXPECT_THROW(assembly.add(pieces_of(std::string(3 * std::size_t{msg::kMaxPieceBytes}, 'x'))[0]),
               std::invalid_argument);
  assembly.add(pieces_of(std::string(60'000, 'x'))[0]);
  EXPECT_THROW(assembly.add(pieces_of("x")[0]), std::invalid_argument) << "of another answer";
  msg::SnapshotPiece beyond = pieces_of(std::string(60'000, 'x'))[1];
  beyond.piece(2);
  EXPECT_THROW(assembly.add(beyond), std::invalid_argument);
  EXPECT_FALSE(assembly.complete());
}

}  // namespace
}  // namespace topogeo::service
