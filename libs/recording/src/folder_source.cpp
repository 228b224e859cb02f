#include "folder_source.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "topogeo/support/foreign_file.hpp"
#include "topogeo/support/yaml_reader.hpp"

namespace topogeo::recording {
namespace {

std::vector<std::filesystem::path> files_of(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "metadata.yaml";
  if (!std::filesystem::exists(file)) {
    throw std::runtime_error(folder.string() +
                             ": expected a folder of rosbag2, got no metadata.yaml in it");
  }
  const support::YamlNode bag =
      support::parse_yaml(support::foreign_content(file, support::kMostYamlBytes), file.string(),
                          "the file")
          .required("rosbag2_bagfile_information");
  std::vector<std::filesystem::path> files;
  for (const support::YamlNode& name : bag.required("relative_file_paths").items()) {
    // Early versions also put the folder in the name.
    const std::filesystem::path path = folder / name.text();
    files.push_back(std::filesystem::exists(path)
                        ? path
                        : folder / std::filesystem::path(name.text()).filename());
    // A subfolder could refer to itself.
    if (std::filesystem::is_directory(files.back())) name.fail("a file");
  }
  if (files.empty()) bag.at("relative_file_paths").fail("a file or more");
  return files;
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
