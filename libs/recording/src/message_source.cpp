#include "topogeo/recording/message_source.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

#include "topogeo/support/foreign_file.hpp"

#include "bag_source.hpp"
#include "folder_source.hpp"
#include "mcap_source.hpp"
#include "sqlite_source.hpp"

namespace topogeo::recording {
namespace {

enum class Format : std::uint8_t { kFolder, kSqlite, kMcap, kBag, kCompressed, kUnknown };

constexpr std::size_t kFirstBytes = 16;

Format format_of(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) return Format::kFolder;
  const std::string start = support::first_bytes(path, kFirstBytes);
  if (start.starts_with("SQLite format 3")) return Format::kSqlite;
  if (start.starts_with("\x89MCAP")) return Format::kMcap;
  if (start.starts_with("#ROSBAG")) return Format::kBag;
  if (start.starts_with("\x28\xB5\x2F\xFD")) return Format::kCompressed;
  return Format::kUnknown;
}

}  // namespace

bool is_recording(const std::filesystem::path& path) {
  constexpr std::array<std::string_view, 4> kNames = {".db3", ".mcap", ".bag", ".zstd"};
  return format_of(path) != Format::kUnknown ||
         std::ranges::find(kNames, path.extension().string()) != kNames.end();
}

std::unique_ptr<MessageSource> open_messages(const std::filesystem::path& path,
                                             TopicFilter wanted) {
  switch (format_of(path)) {
    case Format::kFolder:
      return std::make_unique<FolderSource>(path, std::move(wanted));
    case Format::kSqlite:
      return std::make_unique<SqliteSource>(path, wanted);
    case Format::kMcap:
      return std::make_unique<McapSource>(path, std::move(wanted));
    case Format::kBag:
      return std::make_unique<BagSource>(path, std::move(wanted));
    case Format::kCompressed:
      throw std::runtime_error(path.string() +
                               ": expected a recording, got one compressed as a whole; unpack it "
                               "first with `zstd -d`");
    case Format::kUnknown:
      break;
  }
  if (!std::filesystem::exists(path)) {
    throw std::runtime_error(path.string() + ": expected a file, found none");
  }
  support::refuse_irregular(path);
  throw std::runtime_error(
      path.string() + ": byte 0: expected the first bytes of a .db3, .mcap or .bag, got others");
}

std::string ros2_type_name(std::string_view type) {
  if (type == "tf/tfMessage") return std::string(kTfType);
  const std::size_t first = type.find('/');
  const bool has_middle =
      first != std::string_view::npos && type.find('/', first + 1) != std::string_view::npos;
  if (first == std::string_view::npos || has_middle) return std::string(type);
  return std::string(type.substr(0, first)) + "/msg/" + std::string(type.substr(first + 1));
}

}  // namespace topogeo::recording
