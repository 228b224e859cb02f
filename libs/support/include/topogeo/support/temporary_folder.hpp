// A folder of one's own that goes with the object.
#pragma once

#include <filesystem>
#include <string>

namespace topogeo::support {

class TemporaryFolder {
 public:
  /// In the system's folder for temporary files; `name` is a part of its own. Throws
  /// std::runtime_error when it cannot be made.
  explicit TemporaryFolder(const std::string& name);
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder();

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace topogeo::support
