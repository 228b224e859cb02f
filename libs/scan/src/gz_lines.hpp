// Lines of a text file, plain or gzip, as a stream.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include <zlib.h>

namespace topogeo::scan {

struct GzClose {
  void operator()(gzFile file) const { gzclose(file); }
};
using GzHandle = std::unique_ptr<gzFile_s, GzClose>;

class GzLines {
 public:
  static constexpr std::size_t kMaxLine = std::size_t{1} << 20U;

  struct Line {
    std::string_view text;  ///< without the line end; valid until the next call
    bool too_long = false;  ///< longer than kMaxLine; the text is empty
  };

  /// Throws std::runtime_error unless the path is a readable regular file.
  explicit GzLines(const std::filesystem::path& path);

  /// False at the end of the data. A last line without a line end counts, unless the data is
  /// damaged: then it is a fragment and is dropped.
  bool next(Line& line);

  /// Reason of an early end of the data; empty without one.
  [[nodiscard]] const std::string& damage() const { return damage_; }
  /// Uncompressed bytes read so far.
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }
  [[nodiscard]] double fraction_read() const;

 private:
  void fill();

  GzHandle file_;
  std::uint64_t size_on_disk_ = 0;
  std::string buffer_;
  std::size_t begin_ = 0;
  std::uint64_t bytes_ = 0;
  std::string damage_;
  bool ended_ = false;
};

}  // namespace topogeo::scan
