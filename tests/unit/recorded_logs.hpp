// Recorded logs for tests. They are not part of the project: they are searched in ../shared/data
// beside it, or in the folder that TOPOGEO_LOG_DIR names (*.clf, *.clf.gz).
#pragma once

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

namespace topogeo {

/// Sorted by name; empty without such a folder.
inline std::vector<std::filesystem::path> recorded_logs() {
  std::vector<std::filesystem::path> paths;
  const char* named = std::getenv("TOPOGEO_LOG_DIR");
  const std::filesystem::path folder =
      named != nullptr ? named : TOPOGEO_SOURCE_DIR "/../shared/data";
  if (!std::filesystem::is_directory(folder)) return paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().string().find(".clf") != std::string::npos) paths.push_back(entry.path());
  }
  std::ranges::sort(paths);
  return paths;
}

}  // namespace topogeo
