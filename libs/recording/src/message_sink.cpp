#include "message_sink.hpp"

#include <stdexcept>

#include "bag_sink.hpp"
#include "compression.hpp"
#include "folder_sink.hpp"
#include "input_file.hpp"
#include "mcap_sink.hpp"
#include "sqlite_sink.hpp"

namespace topogeo::recording {
namespace {

Compression known_compression(const std::string& name) {
  try {
    return compression_by_name(name);
  } catch (const FormatError& error) {
    throw std::invalid_argument(std::string("--compression: ") + error.what());
  }
}

}  // namespace

bool is_recording_name(const std::filesystem::path& path) {
  const std::string ending = path.extension().string();
  return ending.empty() || ending == ".mcap" || ending == ".db3" || ending == ".bag";
}

std::unique_ptr<MessageSink> create_sink(const std::filesystem::path& path,
                                         const std::string& compression) {
  const Compression wanted = known_compression(compression);
  const std::string ending = path.extension().string();
  if (ending == ".mcap") {
    if (wanted == Compression::kBz2) {
      throw std::invalid_argument(
          "--compression: expected none, lz4 or zstd for an .mcap, got bz2");
    }
    return std::make_unique<McapSink>(path, wanted);
  }
  if (ending == ".bag") {
    return std::make_unique<BagSink>(path,
                                     wanted == Compression::kZstd ? Compression::kNone : wanted);
  }
  if (ending == ".db3") return std::make_unique<SqliteSink>(path);
  if (ending.empty()) return std::make_unique<FolderSink>(path);
  return nullptr;
}

bool is_latched(std::string_view topic) {
  return topic.ends_with("tf_static") || topic == "/map" || topic == "/graph";
}

std::string qos_profile_text(bool latched) {
  constexpr std::string_view kInfinite = "\n    sec: 9223372036\n    nsec: 854775807";
  std::string text = "- history: 1\n  depth: ";
  text += latched ? "1" : "10";
  text += "\n  reliability: 1\n  durability: ";
  text += latched ? "1" : "2";
  text += "\n  deadline:" + std::string(kInfinite);
  text += "\n  lifespan:" + std::string(kInfinite);
  text += "\n  liveliness: 1\n  liveliness_lease_duration:" + std::string(kInfinite);
  return text + "\n  avoid_ros_namespace_conventions: false";
}

}  // namespace topogeo::recording
