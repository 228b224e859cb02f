// Independent readers: Python programs that follow the rules of the programs for which maps are
// exported.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace topogeo::exchange {

/// Runs readers.py with these words and returns its output. Throws std::runtime_error with the
/// output when it fails.
std::string run_reader(const std::vector<std::string>& words);

/// Runs any program the same way.
std::string run_program(const std::vector<std::string>& words);

}  // namespace topogeo::exchange
