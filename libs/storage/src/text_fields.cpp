#include "text_fields.hpp"

#include <charconv>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <system_error>

#include "topogeo/support/format.hpp"

namespace topogeo::storage {
namespace {

constexpr std::int64_t kNsPerSecond = 1'000'000'000;

bool all_digits(std::string_view text) {
  return text.find_first_not_of("0123456789") == std::string_view::npos;
}

}  // namespace

std::string_view next_word(std::string_view& line) {
  constexpr std::string_view kBlanks = " \t\r";
  const std::size_t start = std::min(line.find_first_not_of(kBlanks), line.size());
  line.remove_prefix(start);
  const std::string_view word = line.substr(0, std::min(line.find_first_of(kBlanks), line.size()));
  line.remove_prefix(word.size());
  return word;
}

std::optional<std::int64_t> parse_stamp(std::string_view word) {
  const bool is_negative = word.starts_with('-');
  if (is_negative) word.remove_prefix(1);
  const std::size_t dot = std::min(word.find('.'), word.size());
  const std::string_view whole = word.substr(0, dot);
  std::string decimals(word.substr(std::min(dot + 1, word.size())));
  if (whole.empty() || !all_digits(whole) || !all_digits(decimals)) return std::nullopt;
  decimals.resize(9, '0');
  std::int64_t seconds = 0;
  std::int64_t ns = 0;
  const auto [end, error] = std::from_chars(whole.data(), whole.data() + whole.size(), seconds);
  std::from_chars(decimals.data(), decimals.data() + decimals.size(), ns);
  constexpr std::int64_t kMaxSeconds = std::numeric_limits<std::int64_t>::max() / kNsPerSecond - 1;
  if (error != std::errc{} || seconds > kMaxSeconds) return std::nullopt;
  const std::int64_t stamp_ns = seconds * kNsPerSecond + ns;
  return is_negative ? -stamp_ns : stamp_ns;
}

std::optional<double> parse_number(std::string_view word) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size() || !std::isfinite(value)) {
    return std::nullopt;
  }
  return value;
}

std::int64_t take_stamp(std::string_view& line, const std::string& where, const char* name) {
  const std::string_view word = next_word(line);
  const auto stamp_ns = parse_stamp(word);
  if (stamp_ns) return *stamp_ns;
  throw std::runtime_error(
      fmt::format("{}: {} '{}': expected seconds such as 12.345678", where, name, word));
}

void take_numbers(std::string_view line, const std::string& where,
                  std::span<const char* const> names, const char* all, std::span<double> values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::string_view word = next_word(line);
    const auto value = parse_number(word);
    if (!value) {
      throw std::runtime_error(
          fmt::format("{}: {} '{}': expected a number, 8 on a line", where, names[i], word));
    }
    values[i] = *value;
  }
  if (!next_word(line).empty()) {
    throw std::runtime_error(fmt::format("{}: more than the 8 numbers {}", where, all));
  }
}

}  // namespace topogeo::storage
