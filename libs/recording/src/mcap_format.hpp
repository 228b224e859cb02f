// Records of MCAP that this library reads and writes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace topogeo::recording::mcap {

inline constexpr std::array<std::uint8_t, 8> kMagic = {0x89, 'M', 'C', 'A', 'P', 0x30, '\r', '\n'};
inline constexpr std::size_t kRecordHead = 9;  ///< opcode and length of the content

enum class Opcode : std::uint8_t {
  kNone = 0x00,  ///< never in an intact file
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0B,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F,
};

}  // namespace topogeo::recording::mcap
