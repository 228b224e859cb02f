#include "text_file.hpp"

#include "topogeo/support/foreign_file.hpp"

namespace topogeo::planning {

std::string read_yaml_file(const std::filesystem::path& path) {
  return support::foreign_content(path, support::kMostYamlBytes);
}

std::string read_image_file(const std::filesystem::path& path) {
  return support::foreign_content(path, support::kMostImageBytes);
}

}  // namespace topogeo::planning
