// A file with a line for each order of an operator or a program: who ordered what, and when.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

namespace topogeo::web {

class AuditLog {
 public:
  static constexpr std::size_t kMostBody_bytes = 1000;

  /// Opens `file` to append; with an empty path no log is kept. Throws std::runtime_error naming
  /// the file if it cannot be opened.
  explicit AuditLog(const std::filesystem::path& file);

  /// Appends {"time","who","order","body"}; a body that is longer than kMostBody_bytes is cut.
  /// Returns false if the line could not be written.
  bool add(std::int64_t wall_ns, const std::string& who, const std::string& order,
           const std::string& body);

 private:
  std::ofstream out_;
  bool kept_ = false;
};

}  // namespace topogeo::web
