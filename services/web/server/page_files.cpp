#include "server/page_files.hpp"

#include <array>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <zlib.h>

#include "topogeo/support/file_content.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/hash.hpp"

namespace topogeo::web {
namespace {

constexpr int kGzipWindow = 15 + 16;  // largest window, with the header of gzip

/// Empty when compression fails.
std::string gzip(const std::string& content) {
  z_stream stream{};
  if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, kGzipWindow, MAX_MEM_LEVEL,
                   Z_DEFAULT_STRATEGY) != Z_OK) {
    return {};
  }
  std::string out(deflateBound(&stream, content.size()), '\0');
  // zlib declares its input as mutable, but does not change it.
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-const-cast)
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(content.data()));
  stream.avail_in = static_cast<uInt>(content.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  const int result = deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return result == Z_STREAM_END ? out : std::string{};
}

}  // namespace

std::string content_type_of(const std::filesystem::path& file) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 10> kTypes = {{
      {".html", "text/html; charset=utf-8"},
      {".js", "text/javascript; charset=utf-8"},
      {".css", "text/css; charset=utf-8"},
      {".json", "application/json"},
      {".webmanifest", "application/manifest+json"},
      {".svg", "image/svg+xml"},
      {".png", "image/png"},
      {".ico", "image/x-icon"},
      {".woff2", "font/woff2"},
      {".txt", "text/plain; charset=utf-8"},
  }};
  const std::string end = file.extension().string();
  for (const auto& [extension, type] : kTypes) {
    if (end == extension) return std::string(type);
  }
  return "application/octet-stream";
}

PageFiles::PageFiles() {
  add("/index.html",
      "<!doctype html><html lang=\"en\"><title>topogeo</title><p>The files of the page are not "
      "installed (share/topogeo/web, or --page DIR). The interface for programs "
      "works.</p></html>\n");
}

PageFiles::PageFiles(const std::filesystem::path& folder) {
  std::error_code error;
  for (auto entry = std::filesystem::recursive_directory_iterator(folder, error);
       !error && entry != std::filesystem::recursive_directory_iterator(); entry.increment(error)) {
    if (!entry->is_regular_file()) continue;
    add("/" + entry->path().lexically_relative(folder).generic_string(),
        support::file_content(entry->path()));
  }
  if (error) throw std::runtime_error(folder.string() + ": " + error.message());
  if (!files_.contains("/index.html")) {
    throw std::runtime_error(folder.string() +
                             ": expected the files of the page, index.html among them");
  }
}

void PageFiles::add(const std::string& path, std::string content) {
  PageFile file;
  file.content_type = content_type_of(path);
  file.etag = fmt::format("\"{:016x}\"", support::fnv1a(content));
  file.compressed = gzip(content);
  if (file.compressed.size() >= content.size()) file.compressed.clear();
  file.content = std::move(content);
  files_.insert_or_assign(path, std::move(file));
}

const PageFile* PageFiles::find(std::string_view path) const {
  std::string name(path);
  if (name == "/") name = "/index.html";
  if (name == "/panel") name = "/panel.html";
  const auto found = files_.find(name);
  return found == files_.end() ? nullptr : &found->second;
}

}  // namespace topogeo::web
