// Text within XML and HTML.
#pragma once

#include <string>
#include <string_view>

namespace topogeo::support {

/// The text with the special characters of markup (& < > ") as entities.
std::string escaped_markup(std::string_view text);

}  // namespace topogeo::support
