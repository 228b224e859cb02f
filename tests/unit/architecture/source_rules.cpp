#include "source_rules.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <stdexcept>

namespace topogeo::architecture {
namespace {

std::string place(const Include& include) {
  return include.file + ":" + std::to_string(include.line) + ": includes " + include.header;
}

/// The part of a path after `root`, up to the next slash: "scan" of "libs/scan/src/scan.cpp".
std::string part_after(std::string_view path, std::string_view root) {
  if (!path.starts_with(root)) return {};
  path.remove_prefix(root.size());
  return std::string(path.substr(0, path.find('/')));
}

bool is_public_header(std::string_view file) {
  if (!file.ends_with(".hpp")) return false;
  return file.starts_with("services/") || file.find("/include/") != std::string_view::npos;
}

bool is_allowed(std::string_view file, const std::vector<std::string_view>& places) {
  return std::ranges::any_of(places, [&](std::string_view place) {
    if (!place.ends_with('/')) return file == place;
    return file.starts_with(place) && !is_public_header(file);
  });
}

std::vector<std::filesystem::path> files_below(const std::filesystem::path& folder) {
  if (!std::filesystem::is_directory(folder)) {
    throw std::runtime_error(folder.string() + ": expected a directory");
  }
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

std::vector<std::filesystem::path> sources_below(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files = files_below(folder);
  std::erase_if(files, [](const std::filesystem::path& file) {
    return file.extension() != ".hpp" && file.extension() != ".cpp";
  });
  return files;
}

/// Syntax of sleeps and comments in a language.
struct Language {
  std::regex sleep;
  std::string comment;
};

/// Null for a file that is no source. A program without an extension counts as a shell script.
const Language* language_of(const std::filesystem::path& file) {
  static const Language kCpp = {
      std::regex(R"re((sleep_for|sleep_until|usleep|nanosleep|::sleep)\()re"), "//"};
  static const Language kPython = {std::regex(R"re(time\.sleep\()re"), "#"};
  static const Language kScript = {std::regex(R"re((setTimeout|waitForTimeout)\()re"), "//"};
  static const Language kShell = {std::regex(R"re((^|[\s;])sleep ["$.0-9])re"), "# "};
  static const std::map<std::string, const Language*> kLanguages = {
      {".cpp", &kCpp},    {".hpp", &kCpp},   {".py", &kPython},
      {".mjs", &kScript}, {".ts", &kScript}, {".sh", &kShell}};
  if (file.has_extension()) {
    const auto found = kLanguages.find(file.extension().string());
    return found == kLanguages.end() ? nullptr : found->second;
  }
  std::string start(2, ' ');
  std::ifstream(file).read(start.data(), 2);
  return start == "#!" ? &kShell : nullptr;
}

}  // namespace

std::vector<Include> includes_below(const std::filesystem::path& root,
                                    const std::vector<std::string>& folders) {
  static const std::regex kInclude(R"re(^\s*#\s*include\s*[<"]([^>"]+)[>"].*)re");
  std::vector<Include> includes;
  for (const std::string& folder : folders) {
    for (const std::filesystem::path& path : sources_below(root / folder)) {
      std::ifstream file(path);
      std::string text;
      for (int line = 1; std::getline(file, text); ++line) {
        std::smatch match;
        if (!std::regex_match(text, match, kInclude)) continue;
        includes.push_back({path.lexically_relative(root).string(), line, match[1]});
      }
    }
  }
  return includes;
}

std::vector<std::string> libraries_in_order(const std::filesystem::path& cmake_lists) {
  std::ifstream file(cmake_lists);
  const std::string text(std::istreambuf_iterator<char>(file), {});
  std::smatch match;
  if (!std::regex_search(text, match, std::regex(R"(foreach\(lib\s+([^)]+)\))"))) {
    throw std::runtime_error(cmake_lists.string() + ": expected foreach(lib ...)");
  }
  std::istringstream names(match[1]);
  return {std::istream_iterator<std::string>(names), {}};
}

std::vector<std::string> against_order(const std::vector<Include>& includes,
                                       const std::vector<std::string>& libraries) {
  std::vector<std::string> found;
  for (const Include& include : includes) {
    const std::string by = part_after(include.file, "libs/");
    const std::string of = part_after(include.header, "topogeo/");
    if (by.empty() || of.empty()) continue;
    if (of == "msg" && (by == "messaging" || by == "map_client")) continue;
    if (of == "ros2" && (by == "ros_conversions" || by == "ros_messaging")) continue;
    const auto user = std::ranges::find(libraries, by);
    if (user == libraries.end()) {
      found.push_back(
          place(include).append(", but '").append(by).append("' is not in libs/CMakeLists.txt"));
    } else if (std::find(libraries.begin(), user, of) == user && of != by) {
      found.push_back(place(include)
                          .append(", but '")
                          .append(of)
                          .append("' does not stand before '")
                          .append(by)
                          .append("' in libs/CMakeLists.txt"));
    }
  }
  return found;
}

std::vector<std::string> out_of_place(const std::vector<Include>& includes,
                                      const std::vector<RestrictedLibrary>& libraries) {
  std::vector<std::string> found;
  for (const Include& include : includes) {
    const RestrictedLibrary* longest = nullptr;
    for (const RestrictedLibrary& library : libraries) {
      if (!include.header.starts_with(library.headers)) continue;
      if (longest == nullptr || library.headers.size() > longest->headers.size()) {
        longest = &library;
      }
    }
    if (longest == nullptr || is_allowed(include.file, longest->places)) continue;
    std::string line = place(include) + ", expected in";
    for (const std::string_view allowed : longest->places) line += " " + std::string(allowed);
    found.push_back(line);
  }
  return found;
}

std::vector<std::string> between_services(const std::filesystem::path& root,
                                          const std::vector<Include>& includes,
                                          const std::vector<std::string_view>& shared) {
  const std::filesystem::path services = root / "services";
  std::vector<std::string> found;
  for (const Include& include : includes) {
    const std::string user = part_after(include.file, "services/");
    if (user.empty() || include.header.starts_with("topogeo/")) continue;
    for (const auto& entry : std::filesystem::directory_iterator(services)) {
      const std::string other = entry.path().filename().string();
      if (other == user || other == "common") continue;
      if (!is_regular_file(entry.path() / include.header)) continue;
      if (exists(services / user / include.header)) continue;  // its own header of that name
      const std::string header = "services/" + other + "/" + include.header;
      if (std::ranges::find(shared, header) == shared.end()) {
        found.push_back(place(include) + ", a header of services/" + other);
      }
    }
  }
  return found;
}

std::vector<std::string> uses_of_research(const std::filesystem::path& root,
                                          const std::vector<Include>& includes) {
  std::set<std::string> headers;  // as #include lines name them
  for (const std::filesystem::path& file : sources_below(root / "research")) {
    const std::string name = file.lexically_relative(root / "research").string();
    const std::size_t folder = name.find("/include/");
    headers.insert(folder == std::string::npos ? name : name.substr(folder + 9));
  }
  std::vector<std::string> found;
  for (const Include& include : includes) {
    if (include.file.starts_with("research/") || !headers.contains(include.header)) continue;
    found.push_back(place(include) + ", a header of research/");
  }
  return found;
}

std::vector<std::string> algorithms_in_settings(const std::vector<Include>& includes) {
  std::vector<std::string> found;
  for (const Include& include : includes) {
    if (!include.file.ends_with("_config.hpp")) continue;
    const std::string& header = include.header;
    const bool standard = header.find_first_of("./") == std::string::npos;
    if (standard || header.starts_with("Eigen/") || header.starts_with("topogeo/geometry/") ||
        header.ends_with("_config.hpp") || header.ends_with("_settings.hpp") ||
        header == "topogeo/support/config_schema.hpp") {
      continue;
    }
    found.push_back(place(include) + ", expected settings alone");
  }
  return found;
}

std::vector<std::string> unused_public_headers(const std::filesystem::path& root,
                                               const std::vector<Include>& includes,
                                               const std::vector<std::string>& libraries) {
  std::map<std::string, std::string> unused;  // file by the name that includes it
  for (const std::string& library : libraries) {
    const std::filesystem::path folder = root / "libs" / library / "include";
    for (const std::filesystem::path& file : sources_below(folder)) {
      unused[file.lexically_relative(folder).string()] = file.lexically_relative(root).string();
    }
  }
  std::set<std::string> used;  // public headers, by file
  for (bool found = true; found;) {
    found = false;
    for (const Include& include : includes) {
      const auto header = unused.find(include.header);
      if (header == unused.end()) continue;
      const std::string library = part_after(header->second, "libs/");
      if (part_after(include.file, "libs/") == library && !used.contains(include.file)) continue;
      used.insert(header->second);
      unused.erase(header);
      found = true;
    }
  }
  std::vector<std::string> lines;
  lines.reserve(unused.size());
  for (const auto& [header, file] : unused) {
    lines.push_back(file + ": only its library includes it, expected in src/");
  }
  return lines;
}

std::vector<std::string> sleeps_without_reason(const std::filesystem::path& root,
                                               const std::string& folder) {
  std::vector<std::string> found;
  for (const std::filesystem::path& path : files_below(root / folder)) {
    const Language* const language = language_of(path);
    if (language == nullptr) continue;
    std::ifstream file(path);
    std::string before;
    std::string text;
    for (int line = 1; std::getline(file, text); ++line, before = text) {
      if (text.find("leep") == std::string::npos && text.find("Timeout") == std::string::npos) {
        continue;  // a fast check that excludes most lines
      }
      const std::string code = text.substr(0, text.find(language->comment));
      if (!std::regex_search(code, language->sleep)) continue;
      if (code != text || before.find(language->comment) != std::string::npos) continue;
      found.push_back(path.lexically_relative(root).string() + ":" + std::to_string(line) +
                      ": sleeps, expected an event or a comment with the reason");
    }
  }
  return found;
}

}  // namespace topogeo::architecture
