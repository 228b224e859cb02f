#include "folder_source.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <yaml-cpp/yaml.h>

namespace topogeo::recording {
namespace {

std::vector<std::filesystem::path> files_of(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "metadata.yaml";
  if (!std::filesystem::exists(file)) {
    throw std::runtime_error(folder.string() +
                             ": expected a folder of rosbag2, got no metadata.yaml in it");
  }
  try {
    const YAML::Node bag = YAML::LoadFile(file.string())["rosbag2_bagfile_information"];
    const auto names = bag["relative_file_paths"].as<std::vector<std::string>>();
    if (names.empty())
      throw std::runtime_error(file.string() + ": expected relative_file_paths, got none");
    std::vector<std::filesystem::path> files;
    // Bags of early versions name the folder too.
    for (const std::string& name : names) {
      const std::filesystem::path path = folder / name;
      files.push_back(
          std::filesystem::exists(path) ? path : folder / std::filesystem::path(name).filename());
    }
    return files;
  } catch (const YAML::Exception& error) {
    throw std::runtime_error(
        file.string() + ": line " + std::to_string(error.mark.line + 1) +
        ": expected rosbag2_bagfile_information with relative_file_paths, got: " + error.msg);
  }
}

}  // namespace

FolderSource::FolderSource(const std::filesystem::path& folder, TopicFilter wanted)
    : wanted_(std::move(wanted)), files_(files_of(folder)) {
  open_next();
}

void FolderSource::open_next() {
  current_ = open_messages(files_[opened_++], wanted_);
  topic_of_current_.clear();
}

bool FolderSource::next(RawMessage& message) {
  while (true) {
    if (current_->next(message)) break;
    if (damage_.empty()) damage_ = current_->damage();
    if (opened_ == files_.size()) return false;
    open_next();
  }
  const std::vector<Topic>& topics = current_->topics();
  for (std::size_t i = topic_of_current_.size(); i < topics.size(); ++i) {
    const auto known = std::ranges::find(topics_, topics[i]);
    topic_of_current_.push_back(static_cast<std::size_t>(known - topics_.begin()));
    if (known == topics_.end()) topics_.push_back(topics[i]);
  }
  message.topic = topic_of_current_[message.topic];
  return true;
}

std::string FolderSource::position() const {
  return files_[opened_ - 1].filename().string() + ": " + current_->position();
}

double FolderSource::fraction_read() const {
  return (static_cast<double>(opened_ - 1) + current_->fraction_read()) /
         static_cast<double>(files_.size());
}

}  // namespace topogeo::recording
