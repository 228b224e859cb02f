// Reads elements of a damaged map one by one, each as the only one of a map file.
#pragma once

#include <exception>
#include <string>
#include <vector>

#include "topogeo/exchange/output_file.hpp"
#include "topogeo/storage/map_document.hpp"
#include "topogeo/support/format.hpp"

namespace topogeo::exchange {

/// Makes a map file of these fields, so that its reader checks them. The last value of a repeated
/// number counts, so an appended one corrects it. Throws std::runtime_error like that reader.
storage::MapDocument read_alone(const std::string& robot_id, const std::string& fields);

/// Calls `take` for each element; notes how many it cannot read.
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
