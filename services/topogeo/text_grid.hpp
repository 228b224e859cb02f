// Tables for terminals.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace topogeo::cli {

/// Width of a terminal that was not resized.
inline constexpr std::size_t kColumns = 80;
/// How much of a name a table shows where there is room, and at least.
inline constexpr std::size_t kLongestName = 16;
inline constexpr std::size_t kShortestName = 4;

/// Cells of a table whose columns are as wide as their widest cell.
class TextGrid {
 public:
  explicit TextGrid(std::vector<std::string> titles) : cells_{std::move(titles)} {}

  /// As many as there are titles. Control characters, which a peer may have put into its name, are
  /// replaced.
  void add(std::vector<std::string> cells);

  /// All of the same width, the titles first; columns of the titles `right` are aligned there.
  [[nodiscard]] std::vector<std::string> lines(const std::set<std::string>& right) const;

 private:
  std::vector<std::vector<std::string>> cells_;
};

/// At most `size` bytes (> 0); what is cut off is shown by "~".
std::string shortened(std::string text, std::size_t size);

/// The lines of a grid, each with its remark behind it where `columns` leave room and in lines of
/// its own below otherwise. `lines` has one more than `remarks`: the titles first.
std::string with_remarks(const std::vector<std::string>& lines, std::string_view title,
                         const std::vector<std::string>& remarks, std::size_t columns);

}  // namespace topogeo::cli
