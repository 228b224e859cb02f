// A trouble that a person must see.
#pragma once

#include <cstdint>
#include <string>

namespace topogeo::web {

struct Alarm {
  std::string level;  ///< "warning" or "error"
  std::string source;
  std::string text;
  std::int64_t first_ns = 0;  ///< wall clock
  std::int64_t last_ns = 0;
  std::uint64_t count = 0;
  std::string acknowledged_by{};  ///< empty: nobody yet
  std::int64_t acknowledged_ns = 0;
  bool operator==(const Alarm&) const = default;
};

}  // namespace topogeo::web
