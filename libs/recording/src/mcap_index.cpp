#include "mcap_index.hpp"

#include <algorithm>
#include <optional>
#include <span>

#include <zlib.h>

#include "mcap_format.hpp"

namespace topogeo::recording {
namespace {

using Bytes = std::span<const std::byte>;

constexpr std::uint64_t kFooterContent = 8 + 8 + 4;
constexpr std::uint64_t kFooterSize = mcap::kRecordHead + kFooterContent + mcap::kMagic.size();
/// Size for two million chunks.
constexpr std::uint64_t kLargestSummary = std::uint64_t{1} << 28U;

std::vector<std::byte> copy_of(Bytes bytes) {
  return {bytes.begin(), bytes.end()};
}

/// The bytes between the start of the summary and its checksum in the footer; empty if that is
/// wrong.
std::vector<std::byte> checked_summary(InputFile& file) {
  if (file.size() < mcap::kMagic.size() + kFooterSize) return {};
  const std::uint64_t footer_at = file.size() - kFooterSize;
  Cursor footer(file.view(footer_at, kFooterSize));
  const bool is_footer =
      footer.number<std::uint8_t>() == static_cast<std::uint8_t>(mcap::Opcode::kFooter) &&
      footer.number<std::uint64_t>() == kFooterContent;
  const auto start = footer.number<std::uint64_t>();
  (void)footer.number<std::uint64_t>();  // of the summary's own offsets
  const auto crc = footer.number<std::uint32_t>();
  if (!is_footer ||
      !std::ranges::equal(footer.take(footer.left()), std::as_bytes(std::span(mcap::kMagic)))) {
    return {};
  }
  if (start < mcap::kMagic.size() || start > footer_at || crc == 0) return {};
  const std::uint64_t size = file.size() - mcap::kMagic.size() - sizeof(crc) - start;
  if (size > kLargestSummary) return {};
  std::vector<std::byte> summary = copy_of(file.view(start, static_cast<std::size_t>(size)));
  const uLong sum =
      crc32_z(0, reinterpret_cast<const unsigned char*>(summary.data()), summary.size());
  if (sum != crc) return {};
  return summary;
}

void take_chunk(Bytes content, std::uint64_t file_size, McapSummary& summary) {
  Cursor cursor(content);
  (void)cursor.number<std::uint64_t>();  // time of the first message
  (void)cursor.number<std::uint64_t>();  // of the last
  const auto start = cursor.number<std::uint64_t>();
  const auto length = cursor.number<std::uint64_t>();
  McapSummary::Chunk chunk;
  Cursor indexes(cursor.take(cursor.number<std::uint32_t>()));
  while (indexes.left() > 0) {
    chunk.channels.push_back(indexes.number<std::uint16_t>());
    (void)indexes.number<std::uint64_t>();  // where its message index is
  }
  const auto index_length = cursor.number<std::uint64_t>();
  if (start > file_size || length > file_size - start ||
      index_length > file_size - start - length) {
    throw FormatError("expected a chunk in the file");
  }
  chunk.end = start + length + index_length;
  summary.chunks[start] = std::move(chunk);
}

}  // namespace

McapSummary read_summary(InputFile& file) {
  try {
    const std::vector<std::byte> bytes = checked_summary(file);
    McapSummary summary;
    for (Cursor cursor(bytes); cursor.left() > 0;) {
      const auto opcode = static_cast<mcap::Opcode>(cursor.number<std::uint8_t>());
      const auto length = cursor.number<std::uint64_t>();
      if (opcode == mcap::Opcode::kFooter) break;
      const Bytes content = cursor.take(length);
      if (opcode == mcap::Opcode::kSchema) summary.schemas.push_back(copy_of(content));
      if (opcode == mcap::Opcode::kChannel) summary.channels.push_back(copy_of(content));
      if (opcode == mcap::Opcode::kChunkIndex) take_chunk(content, file.size(), summary);
    }
    return summary;
  } catch (const FormatError&) {
    return {};
  }
}

}  // namespace topogeo::recording
