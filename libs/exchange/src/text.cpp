#include "text.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <system_error>

#include "topogeo/support/format.hpp"

namespace topogeo::exchange {
namespace {

template <typename Number>
std::optional<Number> parsed(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

std::string number_text(double value) {
  std::array<char, 32> buffer{};
  return {buffer.data(), std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr};
}

std::optional<double> number_of(std::string_view text) {
  const std::optional<double> value = parsed<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<std::uint64_t> whole_number_of(std::string_view text) {
  return parsed<std::uint64_t>(text);
}

std::string seconds_text(std::int64_t stamp_ns) {
  constexpr std::uint64_t kNanoseconds = 1'000'000'000;
  const auto bits = static_cast<std::uint64_t>(stamp_ns);
  const std::uint64_t magnitude = stamp_ns < 0 ? 0 - bits : bits;
  return fmt::format("{}{}.{:09}", stamp_ns < 0 ? "-" : "", magnitude / kNanoseconds,
                     magnitude % kNanoseconds);
}

std::optional<std::int64_t> stamp_of(std::string_view seconds) {
  constexpr std::size_t kDigits = 9;
  constexpr std::int64_t kNanoseconds = 1'000'000'000;
  constexpr std::int64_t kMostSeconds = 9'000'000'000;
  const bool negative = seconds.starts_with('-');
  if (negative) seconds.remove_prefix(1);
  const std::size_t point = seconds.find('.');
  if (point == std::string_view::npos || seconds.size() != point + 1 + kDigits) return std::nullopt;
  const auto whole = whole_number_of(seconds.substr(0, point));
  const auto rest = whole_number_of(seconds.substr(point + 1));
  if (!whole || !rest || *whole > kMostSeconds) return std::nullopt;
  const std::int64_t ns =
      static_cast<std::int64_t>(*whole) * kNanoseconds + static_cast<std::int64_t>(*rest);
  return negative ? -ns : ns;
}

}  // namespace topogeo::exchange
