// Numbers and words of the text formats.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace topogeo::exchange {

/// The shortest text that reads back to the same value.
std::string number_text(double value);

/// The finite number that the whole text consists of; nothing for any other text.
std::optional<double> number_of(std::string_view text);
std::optional<std::uint64_t> whole_number_of(std::string_view text);

/// A stamp in seconds with nine decimals, and the reverse; nothing for any other text.
std::string seconds_text(std::int64_t stamp_ns);
std::optional<std::int64_t> stamp_of(std::string_view seconds);

/// Description of stations that are our base stations.
inline constexpr std::string_view kBaseStation = "base station";

}  // namespace topogeo::exchange
