#include <iterator>

#include "reproduce/chapter4.hpp"
#include "reproduce/chapter7.hpp"
#include "reproduce/chapter8.hpp"
#include "reproduce/experiment.hpp"

namespace topogeo::reproduce {
namespace {

constexpr double kThesisScene_m = 4.0;  // of voronoi::thesis_voronoi()

bool shows_scenes(const Experiment& experiment) {
  return experiment.number.find("Figure 4.") == 0 || experiment.number.find("Figure 5.") == 0;
}

}  // namespace

const std::vector<Experiment>& experiments() {
  static const std::vector<Experiment> kAll = [] {
    std::vector<Experiment> all;
    for (const auto& chapter :
         {chapter4_groups, chapter4_grid, chapter5, chapter6, chapter7_forward, chapter7_backward,
          chapter7_fusion, chapter8_corridor, chapter8_loop, macondo}) {
      std::vector<Experiment> part = chapter();
      for (Experiment& experiment : part) {
        if (shows_scenes(experiment)) experiment.means.laser_range_m = kThesisScene_m;
      }
      all.insert(all.end(), std::make_move_iterator(part.begin()),
                 std::make_move_iterator(part.end()));
    }
    return all;
  }();
  return kAll;
}

}  // namespace topogeo::reproduce
