// How --help shows the value of an option.
#pragma once

#include <memory>

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class FormatterBase;
}  // namespace CLI

namespace topogeo::command_line {

/// CLI11's help with values for people: "--workers N=2 (0 to 256)" instead of
/// "--workers UINT:UINT in [0 - 256]=2".
std::shared_ptr<CLI::FormatterBase> help_format();

}  // namespace topogeo::command_line
