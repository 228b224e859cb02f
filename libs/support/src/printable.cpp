#include "topogeo/support/printable.hpp"

#include <algorithm>

namespace topogeo::support {

std::string printable(std::string_view text) {
  std::string out(text);
  std::ranges::replace_if(out, is_control, '?');
  // U+0080 to U+009F: C2 80 to C2 9F.
  for (std::size_t i = out.find('\xC2'); i != std::string::npos; i = out.find('\xC2', i + 1)) {
    if (i + 1 < out.size() && static_cast<unsigned char>(out[i + 1]) <= 0x9f &&
        static_cast<unsigned char>(out[i + 1]) >= 0x80) {
      out.replace(i, 2, "?");
    }
  }
  return out;
}

}  // namespace topogeo::support
