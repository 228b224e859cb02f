// A temporary folder that is removed with its object.
#pragma once

#include <filesystem>
#include <string>

namespace topogeo::support {

class TemporaryFolder {
 public:
  /// Creates it in the system's folder for temporary files; `name` is a part of its name. Throws
  /// std::runtime_error if it cannot be created.
  explicit TemporaryFolder(const std::string& name);
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder();

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace topogeo::support
