#include "common/text_grid.hpp"

#include <algorithm>
#include <utility>

#include "topogeo/support/printable.hpp"

namespace topogeo::cli {
namespace {

/// Lines of at most `columns` bytes, indented by two blanks and broken between words.
std::string wrapped(const std::string& text, std::size_t columns) {
  const std::string indent = "  ";
  std::string lines;
  std::string line = indent;
  for (std::size_t begin = 0; begin < text.size();) {
    std::size_t end = std::min(text.find(' ', begin), text.size());
    end = std::min(end, begin + columns - indent.size());  // a word without an end
    const std::string word = text.substr(begin, end - begin);
    if (line.size() > indent.size() && line.size() + 1 + word.size() > columns) {
      lines += line + "\n";
      line = indent;
    }
    line += (line.size() > indent.size() ? " " : "") + word;
    begin = end < text.size() && text[end] == ' ' ? end + 1 : end;
  }
  return lines + line + "\n";
}

std::string trimmed(std::string line) {
  line.erase(line.find_last_not_of(' ') + 1);
  return line;
}

}  // namespace

void TextGrid::add(std::vector<std::string> cells) {
  for (std::string& cell : cells) cell = support::printable(cell);
  cells_.push_back(std::move(cells));
}

std::vector<std::string> TextGrid::lines(const std::set<std::string>& right) const {
  std::vector<std::string> lines(cells_.size());
  for (std::size_t c = 0; c < cells_[0].size(); ++c) {
    std::size_t width = 0;
    for (const auto& cells : cells_) width = std::max(width, cells[c].size());
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const std::string& cell = cells_[i][c];
      const std::string blanks(width - cell.size(), ' ');
      lines[i] += (c == 0 ? "" : "  ");
      lines[i] += right.contains(cells_[0][c]) ? blanks + cell : cell + blanks;
    }
  }
  return lines;
}

std::string shortened(std::string text, std::size_t size) {
  if (text.size() > size) text = text.substr(0, size - 1) + "~";
  return text;
}

std::string with_remarks(const std::vector<std::string>& lines, std::string_view title,
                         const std::vector<std::string>& remarks, std::size_t columns) {
  const std::string gap = "  ";
  std::string text = lines[0];
  if (text.size() + gap.size() + title.size() <= columns) text.append(gap).append(title);
  text += '\n';
  for (std::size_t i = 0; i < remarks.size(); ++i) {
    const std::string& line = lines[i + 1];
    const std::string remark = support::printable(remarks[i]);
    const bool beside = remark.empty() || line.size() + gap.size() + remark.size() <= columns;
    std::string whole = line;
    if (beside) whole.append(gap).append(remark);
    text += trimmed(std::move(whole));
    text += '\n';
    if (!beside) text += wrapped(remark, columns);
  }
  return text;
}

}  // namespace topogeo::cli
