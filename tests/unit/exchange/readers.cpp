#include "readers.hpp"

#include <array>
#include <cstdio>
#include <memory>
#include <stdexcept>

namespace topogeo::exchange {

std::string run_program(const std::vector<std::string>& words) {
  std::string command;
  for (const std::string& word : words) command += '\'' + word + "' ";  // no word has a quote
  command += "2>&1";
  const auto close = [](std::FILE* pipe) { return ::pclose(pipe); };
  std::FILE* pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) throw std::runtime_error("cannot start " + command);
  std::string output;
  std::array<char, 4096> buffer{};
  while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe)) {
    output.append(buffer.data(), n);
  }
  if (close(pipe) != 0) throw std::runtime_error(command + ": " + output);
  return output;
}

std::string run_reader(const std::vector<std::string>& words) {
  std::vector<std::string> all = {"/usr/bin/python3",
                                  TOPOGEO_SOURCE_DIR "/tests/unit/exchange/readers.py"};
  all.insert(all.end(), words.begin(), words.end());
  return run_program(all);
}

}  // namespace topogeo::exchange
