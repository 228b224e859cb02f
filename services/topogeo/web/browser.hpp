// Opens a page on the user's screen, if there is one.
#pragma once

#include <filesystem>
#include <string>

namespace topogeo::cli {

/// The link in the first line that a web service prints.
std::string operator_link(const std::string& links);

/// Starts the user's browser (xdg-open) without waiting; does nothing without a screen or a
/// browser. The browser gets `page`, a file of mode 0600 written here that redirects to the link,
/// because `ps` shows the arguments of a browser and the operator's link contains the token.
void open_in_browser(const std::string& link, const std::filesystem::path& page);

}  // namespace topogeo::cli
