#include <iterator>

#include "reproduce/chapter4.hpp"
#include "reproduce/chapter7.hpp"
#include "reproduce/chapter8.hpp"
#include "reproduce/experiment.hpp"

namespace topogeo::reproduce {

const std::vector<Experiment>& experiments() {
  static const std::vector<Experiment> kAll = [] {
    std::vector<Experiment> all;
    for (const auto& chapter :
         {chapter4_groups, chapter4_grid, chapter5, chapter6, chapter7_forward, chapter7_backward,
          chapter7_fusion, chapter8_corridor, chapter8_loop, macondo}) {
      std::vector<Experiment> part = chapter();
      all.insert(all.end(), std::make_move_iterator(part.begin()),
                 std::make_move_iterator(part.end()));
    }
    return all;
  }();
  return kAll;
}

}  // namespace topogeo::reproduce
