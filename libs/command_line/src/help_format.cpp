#include "help_format.hpp"

#include <algorithm>
#include <cctype>
#include <set>
#include <string>
#include <utility>

#include <CLI/CLI.hpp>

namespace topogeo::command_line {
namespace {

/// Shown instead of the names that CLI11 gives to C++ types.
std::string name_of_type(const std::string& type) {
  if (type == "UINT" || type == "INT" || type == "FLOAT") return "N";
  return type;
}

/// "UINT in [0 - 256]" as "0 to 256"; other checks stay as they are.
std::string limits_of(const std::string& check) {
  const std::size_t open = check.find(" in [");
  if (open == std::string::npos || !check.ends_with(']')) return check;
  std::string limits = check.substr(open + 5);
  limits.pop_back();
  const std::size_t middle = limits.find(" - ");
  if (middle != std::string::npos) limits.replace(middle, 3, " to ");
  return limits;
}

bool is_same_word(const std::string& a, const std::string& b) {
  return std::ranges::equal(
      a, b, [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

class HelpFormat : public CLI::Formatter {
 public:
  std::string make_option_opts(const CLI::Option* option) const override {
    std::string text = option->get_type_size() == 0 ? "" : value_of(*option);
    if (!option->get_envname().empty()) text += " (or " + option->get_envname() + ")";
    text += names_of("with ", option->get_needs());
    text += names_of("without ", option->get_excludes());
    return text;
  }

 private:
  static std::string value_of(const CLI::Option& option) {
    const std::string type = option.get_type_name();
    const std::size_t colon = type.find(':');
    std::string name = name_of_type(type.substr(0, colon));
    std::string check = colon == std::string::npos ? "" : limits_of(type.substr(colon + 1));
    if (check.starts_with('{') && (name == "TEXT" || name == "N")) name = std::exchange(check, {});
    // A positional argument is already shown by its name.
    const bool repeated = option.get_positional() && is_same_word(name, option.get_name(true));
    std::string text = name.empty() || repeated ? "" : ' ' + name;
    if (!option.get_default_str().empty()) text += '=' + option.get_default_str();
    if (option.get_expected_max() == CLI::detail::expected_max_vector_size) text += " ...";
    if (!check.empty()) text += check.starts_with('{') ? ' ' + check : " (" + check + ')';
    if (option.get_required()) text += " (required)";
    return text;
  }

  static std::string names_of(const char* relation, const std::set<CLI::Option*>& options) {
    std::string text;
    for (const CLI::Option* option : options) {
      text +=
          (text.empty() ? std::string(" (") + relation : std::string(", ")) + option->get_name();
    }
    return text.empty() ? text : text + ')';
  }
};

}  // namespace

std::shared_ptr<CLI::FormatterBase> help_format() {
  return std::make_shared<HelpFormat>();
}

}  // namespace topogeo::command_line
