// The files of the page, held in memory.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

namespace topogeo::web {

struct PageFile {
  std::string content;
  std::string compressed;  ///< gzip; empty where that is no shorter
  std::string content_type;
  std::string etag;  ///< in quotes
};

class PageFiles {
 public:
  /// Of every regular file of the folder and those below. Throws std::runtime_error naming the
  /// folder or file that cannot be read, and when there is no index.html.
  explicit PageFiles(const std::filesystem::path& folder);
  /// A page of one line that names what is missing: without a folder of the page.
  PageFiles();

  /// Of "/", "/panel", "/app.js"; null when there is none.
  [[nodiscard]] const PageFile* find(std::string_view path) const;

 private:
  void add(const std::string& path, std::string content);

  std::map<std::string, PageFile, std::less<>> files_;
};

/// Of the end of a name; "application/octet-stream" where it is not known.
std::string content_type_of(const std::filesystem::path& file);

}  // namespace topogeo::web
