// Elements of a damaged map, one by one: each is read as if it were alone in a map file.
#pragma once

#include <exception>
#include <string>
#include <vector>

#include "topogeo/exchange/output_file.hpp"
#include "topogeo/storage/map_document.hpp"
#include "topogeo/support/format.hpp"

namespace topogeo::exchange {

/// A map file of these fields; the reader of map files then checks what is in them. A number that
/// comes twice in a message counts as it comes last, so that what follows it corrects it. Throws
/// std::runtime_error like that reader.
storage::MapDocument read_alone(const std::string& robot_id, const std::string& fields);

/// What `take` makes of the elements that it can read; notes how many it cannot.
template <typename Take>
void take_each(const std::vector<std::string>& elements, const char* what, Notes& lost,
               const Take& take) {
  std::size_t bad = 0;
  for (const std::string& element : elements) {
    try {
      take(element);
    } catch (const std::exception&) {
      ++bad;
    }
  }
  if (bad > 0)
    lost.push_back(fmt::format("{} of {} {} cannot be read", bad, elements.size(), what));
}

}  // namespace topogeo::exchange
