// Manual page and shell completion of a program, generated from its declared options.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
class Option;
}  // namespace CLI

namespace topogeo::command_line {

/// The names of its commands.
std::vector<std::string> command_names(const CLI::App& app);

/// Written in man(7): section 1. Lists the commands, which have pages of their own.
std::string manual_page(const CLI::App& app);

/// The page "program-command", with a subsection for each subcommand of the command. Throws
/// UsageError for an unknown command.
std::string manual_page(const CLI::App& app, const std::string& command);

/// Words that complete the value of an option, beside those that its check names.
using WordsOf = std::function<std::vector<std::string>(const CLI::Option&)>;

/// Functions for bash (4.0) that complete subcommands, options and values from a fixed set; other
/// words are completed as files.
std::string bash_completion(const CLI::App& app, const WordsOf& words_of);

}  // namespace topogeo::command_line
