// The list of revoked certificates in a security folder.
#pragma once

#include <filesystem>

namespace topogeo::messaging {

class RevocationList {
 public:
  RevocationList() = default;
  explicit RevocationList(const std::filesystem::path& folder);

  /// Whether the list was written, made or removed since construction or since the last call that
  /// returned true.
  bool take_change();

 private:
  [[nodiscard]] std::filesystem::file_time_type written() const;

  std::filesystem::path file_;  // empty: none
  std::filesystem::file_time_type last_;
};

}  // namespace topogeo::messaging
