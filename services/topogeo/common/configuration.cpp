#include "common/configuration.hpp"

#include <exception>
#include <iostream>

#include "topogeo/service/service_options.hpp"
#include "topogeo/support/alike_lines.hpp"

namespace topogeo::cli {

pipeline::LoadedConfig load(const std::optional<std::filesystem::path>& file) {
  try {
    return pipeline::load_config(file);
  } catch (const std::exception& error) {
    throw service::UsageError(error.what());
  }
}

pipeline::Config read_config(const std::optional<std::filesystem::path>& file) {
  return load(file).config;
}

void print_notes(const std::vector<std::string>& notes) {
  for (const std::string& note : support::merge_alike_lines(notes)) {
    std::cerr << "topogeo: " << note << '\n';
  }
}

}  // namespace topogeo::cli
