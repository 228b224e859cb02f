#include <iterator>

#include "reproduce/experiment.hpp"

namespace topogeo::reproduce {

const std::vector<Experiment>& experiments() {
  static const std::vector<Experiment> kAll = [] {
    std::vector<Experiment> all;
    for (const auto& chapter : {chapter4, chapter5}) {
      std::vector<Experiment> part = chapter();
      all.insert(all.end(), std::make_move_iterator(part.begin()),
                 std::make_move_iterator(part.end()));
    }
    return all;
  }();
  return kAll;
}

}  // namespace topogeo::reproduce
