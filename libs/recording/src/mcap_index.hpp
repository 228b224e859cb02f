// The summary at the end of an MCAP file (https://mcap.dev/spec): which channels each chunk holds,
// so that chunks without a wanted one are passed over unread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "input_file.hpp"

namespace topogeo::recording {

struct McapSummary {
  struct Chunk {
    std::uint64_t end = 0;                ///< byte behind it and its message indexes
    std::vector<std::uint16_t> channels;  ///< those of its messages; empty: not stated
  };

  std::vector<std::vector<std::byte>> schemas;   ///< contents of their records
  std::vector<std::vector<std::byte>> channels;  ///< the same
  std::map<std::uint64_t, Chunk> chunks;         ///< by the byte where the chunk starts
};

/// Empty where the file has no summary, was cut off, or where the checksum of the summary is wrong
/// or missing: an index that is wrong would lose messages unnoticed. Throws std::runtime_error when
/// reading fails.
McapSummary read_summary(InputFile& file);

}  // namespace topogeo::recording
