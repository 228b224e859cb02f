// The summary at the end of an MCAP file (https://mcap.dev/spec): the channels of each chunk, so
// that chunks without a wanted one are skipped unread.
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

/// Empty if the file has no summary, was truncated, or if the checksum of the summary is wrong or
/// missing, because a wrong index would silently lose messages. Throws std::runtime_error if
/// reading fails.
McapSummary read_summary(InputFile& file);

}  // namespace topogeo::recording
