// Opens a page on the user's screen, where there is one.
#pragma once

#include <filesystem>
#include <string>

namespace topogeo::cli {

/// The link in the first of the lines that a web service prints.
std::string operator_link(const std::string& links);

/// Starts the browser that the user has chosen (xdg-open) and goes on; nothing without a screen or
/// a browser. The browser gets `page`, a file of mode 0600 that is written here and leads to the
/// link: `ps` shows what a browser is started with, and the operator's link has the token in it.
void open_in_browser(const std::string& link, const std::filesystem::path& page);

}  // namespace topogeo::cli
