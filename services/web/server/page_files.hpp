// The files of the page, held in memory.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

namespace topogeo::web {

struct PageFile {
  std::string content;
  std::string compressed;  ///< gzip; empty if it would not be shorter
  std::string content_type;
  std::string etag;  ///< in quotes
};

class PageFiles {
 public:
  /// Loads every regular file of the folder and its subfolders. Throws std::runtime_error naming an
  /// unreadable folder or file, or when there is no index.html.
  explicit PageFiles(const std::filesystem::path& folder);
  /// Without a folder: a page of one line that names the missing part.
  PageFiles();

  /// File for a path such as "/", "/panel" or "/app.js"; null when there is none.
  [[nodiscard]] const PageFile* find(std::string_view path) const;

 private:
  void add(const std::string& path, std::string content);

  std::map<std::string, PageFile, std::less<>> files_;
};

/// Content type by the file extension; "application/octet-stream" if unknown.
std::string content_type_of(const std::filesystem::path& file);

}  // namespace topogeo::web
