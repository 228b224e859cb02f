// Numbers and words as the text formats have them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace topogeo::exchange {

/// The shortest text that reads back to the same value.
std::string number_text(double value);

/// A finite number that takes up the whole text; nothing for any other text.
std::optional<double> number_of(std::string_view text);
std::optional<std::uint64_t> whole_number_of(std::string_view text);

/// A stamp in seconds with nine digits behind the point, and back; nothing for any other text.
std::string seconds_text(std::int64_t stamp_ns);
std::optional<std::int64_t> stamp_of(std::string_view seconds);

/// What a station is described as that is a base station of ours.
inline constexpr std::string_view kBaseStation = "base station";

}  // namespace topogeo::exchange
