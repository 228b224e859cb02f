#include "topogeo/command_line/secret_arguments.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>

namespace topogeo::command_line {

SecretArguments::SecretArguments(int count, char** arguments,
                                 std::initializer_list<std::string_view> secret)
    : texts_(arguments, arguments + count) {
  for (const std::string& text : texts_) values_.push_back(text.c_str());
  values_.push_back(nullptr);
  for (int i = 1; i < count; ++i) {
    const std::string_view argument = arguments[i];
    const std::string_view name = argument.substr(0, argument.find('='));
    if (std::ranges::find(secret, name) == secret.end()) continue;
    if (name.size() < argument.size()) {
      hide(arguments[i] + name.size() + 1);
    } else if (i + 1 < count) {
      hide(arguments[++i]);
    }
  }
}

void SecretArguments::hide(char* value) {
  std::memset(value, 'x', std::strlen(value));
  had_secret_ = true;
}

}  // namespace topogeo::command_line
