#include "compression.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <stdexcept>
#include <string>

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

#include "input_file.hpp"

namespace topogeo::recording {
namespace {

/// Above the ratio of any real block, so that a small block with a large promise allocates nothing.
constexpr std::uint64_t kLargestRatio = 100'000;

[[noreturn]] void fail_size(std::uint64_t expected, std::uint64_t got) {
  throw FormatError("expected " + std::to_string(expected) + " bytes from compressed data, got " +
                    std::to_string(got));
}

void decompress_lz4(std::span<const std::byte> block, std::span<std::byte> out) {
  LZ4F_dctx* raw = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&raw, LZ4F_VERSION)) != 0U) {
    throw std::runtime_error("lz4: no memory");
  }
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> context(
      raw, &LZ4F_freeDecompressionContext);
  std::size_t read = 0;
  std::size_t written = 0;
  std::size_t hint = 1;
  while (hint != 0) {
    std::size_t from = block.size() - read;
    std::size_t to = out.size() - written;
    hint = LZ4F_decompress(context.get(), out.data() + written, &to, block.data() + read, &from,
                           nullptr);
    if (LZ4F_isError(hint) != 0U) {
      throw FormatError(std::string("lz4: ") + LZ4F_getErrorName(hint));
    }
    if (from == 0 && to == 0) break;
    read += from;
    written += to;
  }
  if (written != out.size() || hint != 0) fail_size(out.size(), written);
}

void decompress_bz2(std::span<const std::byte> block, std::span<std::byte> out) {
  auto size = static_cast<unsigned int>(out.size());
  char none = 0;
  // The library takes a mutable pointer to constant data, and rejects a null destination.
  auto* from = const_cast<char*>(reinterpret_cast<const char*>(block.data()));
  char* to = out.empty() ? &none : reinterpret_cast<char*>(out.data());
  const int result =
      BZ2_bzBuffToBuffDecompress(to, &size, from, static_cast<unsigned int>(block.size()), 0, 0);
  if (result != BZ_OK) throw FormatError("bz2: error " + std::to_string(result));
  if (size != out.size()) fail_size(out.size(), size);
}

void decompress_zstd_into(std::span<const std::byte> block, std::span<std::byte> out) {
  const std::size_t size = ZSTD_decompress(out.data(), out.size(), block.data(), block.size());
  if (ZSTD_isError(size) != 0U) throw FormatError(std::string("zstd: ") + ZSTD_getErrorName(size));
  if (size != out.size()) fail_size(out.size(), size);
}

std::vector<std::byte> compress_zstd(std::span<const std::byte> block) {
  constexpr int kLevel =
      1;  // like rosbag2's fast preset; recordings are written while a robot drives
  std::vector<std::byte> out(ZSTD_compressBound(block.size()));
  const std::size_t size =
      ZSTD_compress(out.data(), out.size(), block.data(), block.size(), kLevel);
  if (ZSTD_isError(size) != 0U) throw std::runtime_error(ZSTD_getErrorName(size));
  out.resize(size);
  return out;
}

std::vector<std::byte> compress_lz4(std::span<const std::byte> block) {
  // Options that the reader of ROS 1 requires: independent blocks, a checksum of the content.
  LZ4F_preferences_t preferences{};
  preferences.frameInfo.blockMode = LZ4F_blockIndependent;
  preferences.frameInfo.contentChecksumFlag = LZ4F_contentChecksumEnabled;
  std::vector<std::byte> out(LZ4F_compressFrameBound(block.size(), &preferences));
  const std::size_t size =
      LZ4F_compressFrame(out.data(), out.size(), block.data(), block.size(), &preferences);
  if (LZ4F_isError(size) != 0U) throw std::runtime_error(LZ4F_getErrorName(size));
  out.resize(size);
  return out;
}

std::vector<std::byte> compress_bz2(std::span<const std::byte> block) {
  constexpr int kBlockSize_100k = 9;
  // Bound of the library's manual.
  std::vector<std::byte> out(block.size() + block.size() / 100 + 600);
  auto size = static_cast<unsigned int>(out.size());
  auto* from = const_cast<char*>(reinterpret_cast<const char*>(block.data()));
  const int result =
      BZ2_bzBuffToBuffCompress(reinterpret_cast<char*>(out.data()), &size, from,
                               static_cast<unsigned int>(block.size()), kBlockSize_100k, 0, 0);
  if (result != BZ_OK) throw std::runtime_error("bz2: error " + std::to_string(result));
  out.resize(size);
  return out;
}

}  // namespace

Compression compression_by_name(std::string_view name) {
  if (name.empty() || name == "none") return Compression::kNone;
  if (name == "zstd") return Compression::kZstd;
  if (name == "lz4") return Compression::kLz4;
  if (name == "bz2") return Compression::kBz2;
  throw FormatError("expected compression none, zstd, lz4 or bz2, got '" +
                    std::string(name.substr(0, 20)) + "'");
}

UnpackBudget::UnpackBudget(std::uint64_t file_bytes) {
  constexpr std::uint64_t kFree = std::uint64_t{1} << 30U;
  constexpr std::uint64_t kLargestMeanRatio = 100;
  left_ = kFree + kLargestMeanRatio * file_bytes;
}

void UnpackBudget::take(std::uint64_t bytes) {
  if (bytes > left_) {
    throw FormatError("expected a file that unpacks to at most 100 times its size, got more");
  }
  left_ -= bytes;
}

void decompress(std::span<const std::byte> block, Compression compression, std::uint64_t size,
                UnpackBudget& budget, std::vector<std::byte>& out) {
  if (size > kLargestBlock || size > (block.size() + 1) * kLargestRatio) {
    throw FormatError("expected a block of up to 256 MiB, got one of " + std::to_string(size) +
                      " bytes from " + std::to_string(block.size()));
  }
  budget.take(size);
  out.resize(size);
  switch (compression) {
    case Compression::kNone:
      if (block.size() != size) fail_size(size, block.size());
      std::ranges::copy(block, out.begin());
      break;
    case Compression::kZstd:
      decompress_zstd_into(block, out);
      break;
    case Compression::kLz4:
      decompress_lz4(block, out);
      break;
    case Compression::kBz2:
      decompress_bz2(block, out);
      break;
  }
}

bool is_zstd_frame(std::span<const std::byte> data) {
  constexpr std::array<std::byte, 4> kFrame = {std::byte{0x28}, std::byte{0xB5}, std::byte{0x2F},
                                               std::byte{0xFD}};
  return data.size() > kFrame.size() && std::ranges::equal(data.first(kFrame.size()), kFrame);
}

void decompress_zstd(std::span<const std::byte> block, UnpackBudget& budget,
                     std::vector<std::byte>& out) {
  const unsigned long long size = ZSTD_getFrameContentSize(block.data(), block.size());
  if (size == ZSTD_CONTENTSIZE_UNKNOWN || size == ZSTD_CONTENTSIZE_ERROR) {
    throw FormatError("expected a zstd frame that states its size");
  }
  decompress(block, Compression::kZstd, size, budget, out);
}

std::vector<std::byte> compress(std::span<const std::byte> block, Compression compression) {
  switch (compression) {
    case Compression::kZstd:
      return compress_zstd(block);
    case Compression::kLz4:
      return compress_lz4(block);
    case Compression::kBz2:
      return compress_bz2(block);
    case Compression::kNone:
      break;
  }
  return {block.begin(), block.end()};
}

}  // namespace topogeo::recording
