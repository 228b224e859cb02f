// Blocks of a recording that are compressed as a whole: a frame of Zstandard or LZ4, or a stream of
// bzip2.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace topogeo::recording {

enum class Compression : std::uint8_t { kNone, kZstd, kLz4, kBz2 };

/// Parses the name used in files: "", "none", "zstd", "lz4", "bz2". Throws FormatError for other
/// names.
Compression compression_by_name(std::string_view name);

/// Limits the total unpacked size of a file: measured data shrinks to a tenth, a file made to keep
/// its reader busy to a ten-thousandth.
class UnpackBudget {
 public:
  explicit UnpackBudget(std::uint64_t file_bytes);
  /// Call before unpacking `bytes`. Throws FormatError if they exceed the budget.
  void take(std::uint64_t bytes);

 private:
  std::uint64_t left_;
};

/// Unpacks a block of known size. `size` is the size that the file promises: more than
/// kLargestBlock is refused, a different result is an error. Throws FormatError.
inline constexpr std::uint64_t kLargestBlock = std::uint64_t{1} << 28U;
void decompress(std::span<const std::byte> block, Compression compression, std::uint64_t size,
                UnpackBudget& budget, std::vector<std::byte>& out);

/// Whether the bytes begin like a zstd frame, which no message in CDR does.
bool is_zstd_frame(std::span<const std::byte> data);

/// Unpacks a zstd block that states its own size, as in rosbag2's messages. Throws FormatError.
void decompress_zstd(std::span<const std::byte> block, UnpackBudget& budget,
                     std::vector<std::byte>& out);

/// Throws std::runtime_error if compression fails.
std::vector<std::byte> compress(std::span<const std::byte> block, Compression compression);

}  // namespace topogeo::recording
