#include "text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <system_error>

namespace topogeo::exchange {
namespace {

// By topomap::NodeKind.
constexpr std::array<std::string_view, 6> kKindNames = {"real", "fictitious", "virtual",
                                                        "door", "narrowing",  "hall_corridor"};

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

std::string_view name_of(topomap::NodeKind kind) {
  return kKindNames[static_cast<std::size_t>(kind)];
}

std::optional<topomap::NodeKind> node_kind_of(std::string_view name) {
  const auto found = std::ranges::find(kKindNames, name);
  if (found == kKindNames.end()) return std::nullopt;
  return static_cast<topomap::NodeKind>(found - kKindNames.begin());
}

}  // namespace topogeo::exchange
