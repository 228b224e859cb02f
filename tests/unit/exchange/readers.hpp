// Readers that are not ours: Python programs that follow the rules of the programs that maps are
// exported for.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace topogeo::exchange {

/// Runs readers.py with these words; what it prints. Throws std::runtime_error with that when it
/// fails.
std::string run_reader(const std::vector<std::string>& words);

/// Runs any program the same way.
std::string run_program(const std::vector<std::string>& words);

}  // namespace topogeo::exchange
