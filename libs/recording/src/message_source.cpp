#include "topogeo/recording/message_source.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <stdexcept>
#include <utility>

#include <zlib.h>

#include "topogeo/support/foreign_file.hpp"

#include "bag_source.hpp"
#include "folder_source.hpp"
#include "mcap_source.hpp"
#include "sqlite_source.hpp"

namespace topogeo::recording {
namespace {

enum class Format : std::uint8_t { kFolder, kSqlite, kMcap, kBag, kPacked, kUnknown };

constexpr std::size_t kFirstBytes = 512;  // with the mark of a tar archive
constexpr std::size_t kTarMark = 257;     // its place there
constexpr std::string_view kSqliteStart = "SQLite format 3";
constexpr std::string_view kMcapStart = "\x89MCAP";
constexpr std::string_view kBagStart = "#ROSBAG";
constexpr std::string_view kOldBagStart = "#ROSRECORD";

/// A file that must be unpacked first.
struct Packing {
  std::string_view start;  ///< its first bytes
  std::string_view name;
  std::string_view command;
  std::string_view result = "";  ///< what the command leaves to give in its place
};

constexpr std::array<Packing, 7> kPackings = {Packing{"\x28\xB5\x2F\xFD", "zstd", "zstd -d"},
                                              Packing{"\xFD"
                                                      "7zXZ",
                                                      "xz", "unxz"},
                                              Packing{"BZh", "bzip2", "bunzip2"},
                                              Packing{"\x04\x22\x4D\x18", "lz4", "unlz4"},
                                              Packing{"PK\x03\x04", "zip", "unzip"},
                                              Packing{"7z\xBC\xAF\x27\x1C", "7-Zip", "7z x"},
                                              Packing{"Rar!", "rar", "unrar x"}};
constexpr Packing kGzip{"\x1F\x8B", "gzip", "gunzip"};
constexpr Packing kGzipTwice{"\x1F\x8B", "gzip twice", "gunzip"};
constexpr std::string_view kInside = ", then give the file or folder that was in it";
constexpr Packing kTar{"", "tar", "tar xf", kInside};
constexpr Packing kTarGzip{"\x1F\x8B", "tar and gzip", "tar xzf", kInside};

/// The first unpacked bytes of a file of gzip.
std::string first_unpacked_bytes(const std::filesystem::path& path) {
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> file(gzopen(path.c_str(), "rb"), &gzclose);
  std::string bytes(kFirstBytes, '\0');
  const int count =
      file ? gzread(file.get(), bytes.data(), static_cast<unsigned>(bytes.size())) : 0;
  bytes.resize(static_cast<std::size_t>(std::max(0, count)));
  return bytes;
}

Format format_of_start(std::string_view start) {
  if (start.starts_with(kSqliteStart)) return Format::kSqlite;
  if (start.starts_with(kMcapStart)) return Format::kMcap;
  if (start.starts_with(kBagStart)) return Format::kBag;
  return Format::kUnknown;
}

bool is_tar(std::string_view start) {
  return start.size() > kTarMark && start.substr(kTarMark).starts_with("ustar");
}

/// Null for a file that is not packed. CARMEN logs of gzip are read as they are.
const Packing* packing_of(const std::filesystem::path& path, std::string_view start) {
  if (is_tar(start)) return &kTar;
  const auto* found = std::ranges::find_if(
      kPackings, [&](const Packing& packing) { return start.starts_with(packing.start); });
  if (found != kPackings.end()) return found;
  if (!start.starts_with(kGzip.start)) return nullptr;
  const std::string unpacked = first_unpacked_bytes(path);
  const bool is_named_tar = path.extension() == ".tgz" || path.stem().extension() == ".tar";
  if (is_named_tar || is_tar(unpacked)) return &kTarGzip;
  if (unpacked.starts_with(kGzip.start)) return &kGzipTwice;
  return format_of_start(unpacked) != Format::kUnknown ? &kGzip : nullptr;
}

Format format_of(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) return Format::kFolder;
  const std::string start = support::first_bytes(path, kFirstBytes);
  if (packing_of(path, start) != nullptr) return Format::kPacked;
  return format_of_start(start);
}

[[noreturn]] void refuse_packed(const std::filesystem::path& path) {
  const Packing* packing = packing_of(path, support::first_bytes(path, kFirstBytes));
  if (packing == nullptr) throw std::runtime_error(path.string() + ": has changed meanwhile");
  throw std::runtime_error(path.string() + ": expected a log or a recording, got one packed with " +
                           std::string(packing->name) + "; unpack it first with `" +
                           std::string(packing->command) + " " + path.string() + "`" +
                           std::string(packing->result));
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
    case Format::kPacked:
      refuse_packed(path);
    case Format::kUnknown:
      break;
  }
  if (!std::filesystem::exists(path)) {
    throw std::runtime_error(path.string() + ": expected a file, found none");
  }
  support::refuse_irregular(path);
  if (support::first_bytes(path, kFirstBytes).starts_with(kOldBagStart)) {
    throw std::runtime_error(path.string() +
                             ": a bag of version 1, expected version 2.0; ROS 1 converts it with "
                             "`rosbag filter " +
                             path.string() + " new.bag True`");
  }
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
