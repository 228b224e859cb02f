// The types of the IDL files, read at run time, so that tests cover new messages automatically.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <stdexcept>
#include <string>
#include <vector>

namespace topogeo::test {

struct IdlMember {
  std::string type;  ///< as in the file, without @key
  std::string name;
};

/// Parses files in the style of idl/: one line for each member, arrays only in type definitions.
class IdlSchema {
 public:
  /// Throws std::runtime_error when there is no struct in the *.idl of the folder.
  explicit IdlSchema(const std::filesystem::path& folder) {
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      if (entry.path().extension() != ".idl") continue;
      std::ifstream file(entry.path());
      add({std::istreambuf_iterator<char>(file), {}});
    }
    if (structs_.empty()) throw std::runtime_error("no IDL in " + folder.string());
  }

  [[nodiscard]] bool is_struct(const std::string& type) const { return structs_.contains(type); }
  [[nodiscard]] const std::vector<IdlMember>& members(const std::string& type) const {
    return structs_.at(type);
  }
  /// Number of values of an enumeration, counted from 0; 0 for other types.
  [[nodiscard]] std::size_t enumerators(const std::string& type) const {
    const auto found = enums_.find(type);
    return found == enums_.end() ? 0 : found->second;
  }
  /// Size of an array of double; 0 for other types.
  [[nodiscard]] std::size_t array_size(const std::string& type) const {
    const auto found = arrays_.find(type);
    return found == arrays_.end() ? 0 : found->second;
  }
  /// Value of a number, or of a named constant.
  [[nodiscard]] std::uint64_t constant(const std::string& text) const {
    const auto found = constants_.find(text);
    return std::stoull(found == constants_.end() ? text : found->second);
  }

 private:
  void add(const std::string& file) {
    const std::string text = std::regex_replace(file, std::regex("//[^\n]*"), "");
    for_each(text, R"(const [a-z ]+ (\w+) = (\w+);)",
             [this](const std::smatch& found) { constants_[found[1]] = found[2]; });
    for_each(text, R"(typedef double (\w+)\[(\d+)\];)",
             [this](const std::smatch& found) { arrays_[found[1]] = std::stoul(found[2]); });
    for_each(text, R"(enum (\w+) \{([^}]*)\})", [this](const std::smatch& found) {
      std::size_t& count = enums_[found[1]];
      for_each(found[2], R"(\w+)", [&count](const std::smatch&) { ++count; });
    });
    for_each(text, R"(struct (\w+) \{([^}]*)\})", [this](const std::smatch& found) {
      std::vector<IdlMember>& members = structs_[found[1]];
      for_each(found[2], R"((?:@key +)?(\S[^;]*) (\w+);)", [&members](const std::smatch& member) {
        members.push_back({member[1], member[2]});
      });
    });
  }

  template <class Use>
  static void for_each(const std::string& text, const char* pattern, const Use& use) {
    const std::regex expression(pattern);
    std::for_each(std::sregex_iterator(text.begin(), text.end(), expression),
                  std::sregex_iterator(), use);
  }

  std::map<std::string, std::vector<IdlMember>> structs_;
  std::map<std::string, std::size_t> enums_;
  std::map<std::string, std::size_t> arrays_;
  std::map<std::string, std::string> constants_;
};

}  // namespace topogeo::test
