// Opens a page on the user's screen, where there is one.
#pragma once

#include <string>

namespace topogeo::cli {

/// The link in the first of the lines that a web service prints.
std::string operator_link(const std::string& links);

/// Starts the browser that the user has chosen (xdg-open) and goes on; nothing without a screen or
/// a browser.
void open_in_browser(const std::string& link);

}  // namespace topogeo::cli
