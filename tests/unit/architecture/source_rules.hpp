// Checks which files of a source tree include which others, by their #include lines.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace topogeo::architecture {

struct Include {
  std::string file;  ///< relative to the root: libs/scan/src/scan.cpp
  int line = 0;
  std::string header;  ///< without brackets or quotes
};

/// Includes of all .hpp and .cpp files below the folders, sorted by path. Throws std::runtime_error
/// for a folder that does not exist.
std::vector<Include> includes_below(const std::filesystem::path& root,
                                    const std::vector<std::string>& folders);

/// The names in `foreach(lib ...)` of a CMakeLists.txt. Throws std::runtime_error without any.
std::vector<std::string> libraries_in_order(const std::filesystem::path& cmake_lists);

/// A library that takes long to compile or belongs to one layer, and the places that may include
/// it: files, or folders, which end in '/' and exclude the public headers in them. When several
/// libraries match a header, the one with the longest prefix counts.
struct RestrictedLibrary {
  std::string_view headers;  ///< prefix of their names
  std::vector<std::string_view> places;
};

/// Each of these returns a line for each include that breaks the rule.

/// A library includes headers of itself and of those before it; only libs/messaging the messages.
std::vector<std::string> against_order(const std::vector<Include>& includes,
                                       const std::vector<std::string>& libraries);

std::vector<std::string> out_of_place(const std::vector<Include>& includes,
                                      const std::vector<RestrictedLibrary>& libraries);

/// services/a includes no header of services/b, unless `shared` names the header.
std::vector<std::string> between_services(const std::filesystem::path& root,
                                          const std::vector<Include>& includes,
                                          const std::vector<std::string_view>& shared);

/// The product includes no header of research/.
std::vector<std::string> uses_of_research(const std::filesystem::path& root,
                                          const std::vector<Include>& includes);

/// A header of settings, *_config.hpp, includes no algorithm: only settings, geometry and the
/// declaration of settings.
std::vector<std::string> algorithms_in_settings(const std::vector<Include>& includes);

/// Public headers of these libraries that no other library and no service needs, neither directly
/// nor through another public header: their place is in src/.
std::vector<std::string> unused_public_headers(const std::filesystem::path& root,
                                               const std::vector<Include>& includes,
                                               const std::vector<std::string>& libraries);

/// Lines of C++, Python, browser and shell sources below a folder that sleep for a time without a
/// comment with the reason, beside it or in the line before: tests wait for events.
std::vector<std::string> sleeps_without_reason(const std::filesystem::path& root,
                                               const std::string& folder);

}  // namespace topogeo::architecture
