#include "folder_source.hpp"

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>

#include "topogeo/support/foreign_file.hpp"
#include "topogeo/support/yaml_reader.hpp"

namespace topogeo::recording {
namespace {

/// The file that metadata.yaml names, in any form in which it is there.
std::filesystem::path part_of(const std::filesystem::path& folder, const std::string& name) {
  // Early versions also put the folder in the name, and people unpack files of .zstd.
  std::filesystem::path path = folder / name;
  if (!std::filesystem::exists(path)) path = folder / std::filesystem::path(name).filename();
  if (path.extension() != ".zstd") return path;
  std::filesystem::path unpacked = path;
  unpacked.replace_extension();
  return std::filesystem::exists(unpacked) ? unpacked : path;
}

/// "drive_", 12 and ".mcap" for "drive_12.mcap".
struct PartName {
  std::string stem;
  std::uint64_t number = 0;
  std::string ending;
};

PartName part_name(const std::filesystem::path& path) {
  const std::string stem = path.stem().string();
  const std::size_t digits = stem.find_last_not_of("0123456789") + 1;
  constexpr std::size_t kMostDigits = 18;
  PartName name{stem.substr(0, digits), 0, path.extension().string()};
  if (digits < stem.size()) name.number = std::stoull(stem.substr(digits).substr(0, kMostDigits));
  return name;
}

/// The parts of a recording whose recorder did not write metadata.yaml, by their numbers. Files of
/// several recordings are refused.
std::vector<std::filesystem::path> parts_without_metadata(const std::filesystem::path& folder) {
  const std::string expected = folder.string() +
                               ": expected a folder of rosbag2 with metadata.yaml, or with the "
                               "parts of one recording (NAME_0.mcap or .db3, NAME_1 ...), got ";
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string ending = entry.path().extension().string();
    if (entry.is_regular_file() && (ending == ".mcap" || ending == ".db3")) {
      files.push_back(entry.path());
    }
  }
  if (files.empty()) throw std::runtime_error(expected + "neither");
  std::ranges::sort(files, {}, [](const std::filesystem::path& path) {
    return std::pair(part_name(path).number, path.filename().string());
  });
  const PartName first = part_name(files.front());
  for (const std::filesystem::path& file : files) {
    const PartName name = part_name(file);
    if (name.stem == first.stem && name.ending == first.ending) continue;
    throw std::runtime_error(expected + files.front().filename().string() + " and " +
                             file.filename().string());
  }
  return files;
}

std::vector<std::filesystem::path> files_of(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "metadata.yaml";
  if (!std::filesystem::exists(file)) return parts_without_metadata(folder);
  const support::YamlNode bag =
      support::parse_yaml(support::foreign_content(file, support::kMostYamlBytes), file.string(),
                          "the file")
          .required("rosbag2_bagfile_information");
  std::vector<std::filesystem::path> files;
  for (const support::YamlNode& name : bag.required("relative_file_paths").items()) {
    files.push_back(part_of(folder, name.text()));
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
