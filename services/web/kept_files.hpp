// Files that outlive the service.
#pragma once

#include <filesystem>

namespace topogeo::web {

/// An empty path: none.
struct KeptFiles {
  std::filesystem::path memory{};  ///< an operator's stop that no base reports
  std::filesystem::path audit{};   ///< gets each order
  std::filesystem::path alarms{};  ///< the alarms and who acknowledged them
};

}  // namespace topogeo::web
