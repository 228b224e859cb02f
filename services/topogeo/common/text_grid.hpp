// Tables for terminals.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace topogeo::cli {

/// Default width of a terminal.
inline constexpr std::size_t kColumns = 80;
/// Largest and smallest number of columns for a name.
inline constexpr std::size_t kLongestName = 16;
inline constexpr std::size_t kShortestName = 4;

/// Cells of a table whose columns are as wide as their widest cell.
class TextGrid {
 public:
  explicit TextGrid(std::vector<std::string> titles) : cells_{std::move(titles)} {}

  /// Adds as many cells as there are titles. Control characters, which a peer may have put into its
  /// name, are replaced.
  void add(std::vector<std::string> cells);

  /// Lines of equal width, the titles first; the columns with titles in `right` are right-aligned.
  [[nodiscard]] std::vector<std::string> lines(const std::set<std::string>& right) const;

 private:
  std::vector<std::vector<std::string>> cells_;
};

/// At most `size` bytes (> 0); "~" marks a cut.
std::string shortened(std::string text, std::size_t size);

/// The lines of a grid, each followed by its remark if `columns` leave room, otherwise with the
/// remark on lines below. `lines` has one entry more than `remarks`: the titles first.
std::string with_remarks(const std::vector<std::string>& lines, std::string_view title,
                         const std::vector<std::string>& remarks, std::size_t columns);

}  // namespace topogeo::cli
