// Manual page and shell completion of a program, generated from its declared options.
#pragma once

#include <string>

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
}  // namespace CLI

namespace topogeo::command_line {

/// Written in man(7): section 1, with a subsection for each subcommand.
std::string manual_page(const CLI::App& app);

/// Functions for bash (4.0) that complete subcommands, options and values from a fixed set; other
/// words are completed as files.
std::string bash_completion(const CLI::App& app);

}  // namespace topogeo::command_line
