#include "folder_sink.hpp"

#include <algorithm>
#include <fstream>
#include <stdexcept>

#include <yaml-cpp/yaml.h>

namespace topogeo::recording {
namespace {

/// Version of Humble, which later releases also read.
constexpr int kMetadataVersion = 5;

/// Removes a trailing slash.
std::filesystem::path folder_name(const std::filesystem::path& folder) {
  return folder.has_filename() ? folder : folder.parent_path();
}

std::filesystem::path made(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw std::runtime_error(folder.string() + ": cannot be created: " + error.message());
  if (!std::filesystem::is_empty(folder, error) || error) {
    throw std::runtime_error(folder.string() + ": expected a folder that is new or empty");
  }
  return folder;
}

}  // namespace

FolderSink::FolderSink(const std::filesystem::path& folder)
    : folder_(made(folder_name(folder))),
      file_(folder_.filename().string() + "_0.db3"),
      messages_(folder_ / file_) {}

void FolderSink::write(const OutputMessage& message) {
  messages_.write(message);
  Topic& topic = topics_[message.topic];
  topic.type = message.type;
  ++topic.messages;
  first_ns_ = count_ == 0 ? message.time_ns : std::min(first_ns_, message.time_ns);
  last_ns_ = count_ == 0 ? message.time_ns : std::max(last_ns_, message.time_ns);
  ++count_;
}

void FolderSink::close() {
  messages_.close();
  YAML::Node file;
  file["starting_time"]["nanoseconds_since_epoch"] = first_ns_;
  file["duration"]["nanoseconds"] = last_ns_ - first_ns_;
  file["message_count"] = count_;
  YAML::Node bag;
  bag["version"] = kMetadataVersion;
  bag["storage_identifier"] = "sqlite3";
  for (const char* key : {"duration", "starting_time", "message_count"}) {
    bag[key] = YAML::Clone(file[key]);
  }
  for (const auto& [name, facts] : topics_) {
    YAML::Node topic;
    topic["topic_metadata"]["name"] = name;
    topic["topic_metadata"]["type"] = facts.type;
    topic["topic_metadata"]["serialization_format"] = "cdr";
    topic["topic_metadata"]["offered_qos_profiles"] = qos_profile_text(is_latched(name));
    topic["message_count"] = facts.messages;
    bag["topics_with_message_count"].push_back(topic);
  }
  bag["compression_format"] = "";
  bag["compression_mode"] = "";
  bag["relative_file_paths"].push_back(file_);
  file["path"] = file_;
  bag["files"].push_back(file);
  YAML::Node whole;
  whole["rosbag2_bagfile_information"] = bag;
  std::ofstream out(folder_ / "metadata.yaml");
  out << whole << '\n';
  out.close();
  if (!out) throw std::runtime_error((folder_ / "metadata.yaml").string() + ": cannot be written");
}

}  // namespace topogeo::recording
