#include "reproduce/tolerances.hpp"

#include <algorithm>

namespace topogeo::reproduce {
namespace {

bool matches(std::string_view pattern, std::string_view name) {
  if (!pattern.ends_with('*')) return pattern == name;
  return name.starts_with(pattern.substr(0, pattern.size() - 1));
}

}  // namespace

const std::vector<Tolerance>& tolerances() {
  static const std::vector<Tolerance> kTolerances{
      {"figure-4.7", "*", 0.025, "half a cell of 5 cm; counts are whole numbers"},
      {"figure-4.8", "node to the middle of the crossing", 0.03, "a cell's half diagonal"},
      {"figure-4.19", "distance to the wall, off its perpendicular", 0.01,
       "spacing of the readings on the wall"},
      {"table-4.1", "*", 0.0075, "the print has two decimals, truncated"},
      {"figure-5.3", "state above the least clearance", 0.01, "a fifth of a cell"},
      {"figure-5.4", "state to where the scene has it", 0.05, "a cell"},
      {"figure-5.5", "state to where the scene has it", 0.05, "a cell"},
      {"figure-5.7", "state to where the scene has it", 0.05, "a cell"},
      {"table-6.1", "*", 0.0006, "the print has three decimals"},
      {"figure-6.4", "rectangle beyond its ellipse, of its half side", 0.01,
       "ellipses are drawn with 60 points"},
      {"table-6.2", "*", 0.0051, "the print has two decimals"},
      {"table-6.4", "*", 0.3, "deviation of 400,000 spins, and one decimal of the print"},
      {"figure-6.1*", "printed form: fitness where they lie on each other", 0.05,
       "half the distance of the published panels (e) and (f) of figure 6.16"},
      {"figure-6.1*", "printed form: fitness far off", 0.001, "the print has one decimal"},
      {"figure-7.9", "union of the corners by the total, area", 0.01, "rounding"},
      {"figure-7.11", "points of branches whose clearance is the distance to the walls", 10.0,
       "small things that are no group of their own"},
      {"figure-7.21", "odometry corrected by", 0.30, "a quarter of the published correction"},
      {"figure-7.21", "heading corrected by", 0.0175, "half of the published correction"},
      {"figure-7.27-7.29", "positions beyond their search space (1: its border)", 0.01, "rounding"},
      {"figure-8.9", "branches through the shut door", 0.10, "two cells"},
      {"figure-8.13", "stops up to the last published position", 3.0, "a stop each 1 to 2 m"},
      {"figure-8.13", "odometry off there", 1.5, "a sixth of the published value"},
      {"figure-8.13", "heading off there", 3.0, "a sixth of the published value"},
      {"figure-8.16", "error, of that of the forward correction", 0.10, "two cells"},
      {"figure-8.18", "error, of that of the forward correction", 0.10, "two cells"},
      {"figure-8.20", "error, of that of the forward correction", 0.10, "two cells"},
      {"figure-8.22", "error, of that of the forward correction", 0.10, "two cells"},
      {"macondo-figure-8", "*", 1e-6, "rounding"},
      {"macondo-reliability", "readings from 2.5 to 5 m that are off", 15.0,
       "a tenth of the readings that err do so by less than can be seen"},
      {"macondo-reliability", "largest error from 2.5 to 5 m", 0.10, "a cell"},
      {"macondo-planner", "*", 0.05, "the border's middle may cost a twentieth"},
      {"macondo-arrival", "*", 1.0, "two drives of 200"},
  };
  return kTolerances;
}

const Tolerance* find_tolerance(std::string_view experiment, std::string_view value) {
  const auto at = std::ranges::find_if(tolerances(), [&](const Tolerance& entry) {
    return matches(entry.experiment, experiment) && matches(entry.value, value);
  });
  return at == tolerances().end() ? nullptr : &*at;
}

double tolerance_of(std::string_view experiment, std::string_view value) {
  constexpr double kExact = 1e-9;
  const Tolerance* entry = find_tolerance(experiment, value);
  return entry == nullptr ? kExact : entry->tolerance;
}

}  // namespace topogeo::reproduce
