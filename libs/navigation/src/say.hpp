// Lines for people.
#pragma once

#include <array>
#include <cstdarg>
#include <cstdio>
#include <string>

namespace topogeo::navigation {

/// printf into a string of at most 239 characters.
#if defined(__GNUC__)
__attribute__((format(printf, 1, 2)))
#endif
inline std::string
say(const char* format, ...) {
  std::array<char, 240> text{};
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text.data(), text.size(), format, arguments);
  va_end(arguments);
  return text.data();
}

}  // namespace topogeo::navigation
