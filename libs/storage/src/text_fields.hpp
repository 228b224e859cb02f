// Numbers in lines of text files, separated by blanks.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace topogeo::storage {

/// The next word, and the rest in `line`; empty at the end.
std::string_view next_word(std::string_view& line);

/// Seconds such as "12.345678" or "-3" in nanoseconds, digit by digit; digits below 1 ns are cut
/// off. Nothing for other texts and for times beyond the range of nanoseconds.
std::optional<std::int64_t> parse_stamp(std::string_view word);

/// The finite number that the whole word consists of.
std::optional<double> parse_number(std::string_view word);

/// The stamp called `name` at the start of the line, and the rest in `line`; ns. Throws
/// std::runtime_error naming `where` and the name.
std::int64_t take_stamp(std::string_view& line, const std::string& where, const char* name);

/// The finite numbers in the rest of a line of 8, one for each of `values`, called `names` in
/// errors (as many). `all`: the names of all 8 fields. Throws std::runtime_error naming `where` and
/// the field.
void take_numbers(std::string_view line, const std::string& where,
                  std::span<const char* const> names, const char* all, std::span<double> values);

/// Calls `use(line, where)` for each line that is neither blank nor a comment ('#'); `where` is
/// "NAME:NUMBER".
template <typename Use>
void for_each_line(std::string_view text, const std::string& name, const Use& use) {
  for (std::size_t line_number = 1; !text.empty(); ++line_number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.starts_with('#') || line.find_first_not_of(" \t\r") == std::string_view::npos) {
      continue;
    }
    use(line, name + ":" + std::to_string(line_number));
  }
}

}  // namespace topogeo::storage
