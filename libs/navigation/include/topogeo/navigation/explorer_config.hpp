// Settings of exploration: the choice of targets, and limits of time and attempts.
#pragma once

#include <cstdint>

namespace topogeo::support {
class ConfigSchema;
}

namespace topogeo::navigation {

struct ExplorerConfig {
  double unknown_near_m = 0.8;
  double sight_m = 4.0;
  double least_area_m2 = 0.2;
  double worth_m_per_m2 = 40.0;
  double passage_side_m = 1.0;
  double gap_side_m = 1.0;
  double least_gap_m = 0.3;
  double approach_m = 1.0;
  double view_m = 3.0;
  double sure_m = 0.35;
  double together_m = 1.5;
  std::uint32_t tour = 10;
  double least_room_m2 = 1.0;
};

struct TourConfig {
  ExplorerConfig explorer;
  double patience_s = 12.0;
  double settle_s = 3.0;
};

// They declare the section `explorer`; that of the tour includes that of its explorer.
void describe(ExplorerConfig& config, support::ConfigSchema& schema);
void describe(TourConfig& config, support::ConfigSchema& schema);

// They throw std::invalid_argument naming key, value and range.
void check(const ExplorerConfig& config);
void check(const TourConfig& config);

}  // namespace topogeo::navigation
