// Blocks of a recording that are compressed as a whole: a frame of Zstandard, one of LZ4, a stream
// of bzip2.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace topogeo::recording {

enum class Compression : std::uint8_t { kNone, kZstd, kLz4, kBz2 };

/// By the name that files give it: "", "none", "zstd", "lz4", "bz2". Throws FormatError for
/// another.
Compression compression_by_name(std::string_view name);

/// How much a file may unpack to in all: what is measured shrinks to a tenth, a file made to keep
/// its reader busy to a ten-thousandth.
class UnpackBudget {
 public:
  explicit UnpackBudget(std::uint64_t file_bytes);
  /// Before so many bytes are unpacked. Throws FormatError when they are too many.
  void take(std::uint64_t bytes);

 private:
  std::uint64_t left_;
};

/// A block of known size. `size` is what the file promises: more than kLargestBlock is refused,
/// less or more than comes out is an error. Throws FormatError.
inline constexpr std::uint64_t kLargestBlock = std::uint64_t{1} << 28U;
void decompress(std::span<const std::byte> block, Compression compression, std::uint64_t size,
                UnpackBudget& budget, std::vector<std::byte>& out);

/// A block of zstd that states its own size, as rosbag2 compresses messages. Throws FormatError.
void decompress_zstd(std::span<const std::byte> block, UnpackBudget& budget,
                     std::vector<std::byte>& out);

/// Throws std::runtime_error when that fails.
std::vector<std::byte> compress(std::span<const std::byte> block, Compression compression);

}  // namespace topogeo::recording
