#include "topogeo/session/place_confirmation.hpp"

#include <optional>

namespace topogeo::localization {

namespace {

// Required successive tracking after a search, before a drive joins the map. In the wrong room a
// robot is tracked while it turns, but not much further (continue_test).
constexpr std::uint32_t kTrackedStops = 3;
constexpr double kTrackedDistance_m = 4.0;
// Limits of contradiction() with changed doors and people about; a wrong corridor differs more.
constexpr double kContradicted = 0.3;      // in the mean over that distance
constexpr double kContradictedOnce = 0.5;  // by one stop

}  // namespace

bool tracked_well(const MapTracker& tracker) {
  const std::optional<TrackedStep>& step = tracker.last_step();
  return tracker.status().state == LocalizationState::kTracking && step &&
         !step->accepted.empty() && contradiction(step->evidence) <= kContradictedOnce;
}

bool PlaceConfirmation::add(const MapTracker& tracker) {
  const std::optional<TrackedStep>& step = tracker.last_step();
  if (!step) searched_ = true;
  if (!tracked_well(tracker)) {
    stops_ = 0;
    distance_m_ = contradiction_ = 0.0;
    return false;
  }
  ++stops_;
  distance_m_ += step->evidence.distance_m;
  contradiction_ += contradiction(step->evidence);
  const bool alike = contradiction_ <= kContradicted * stops_;
  return alike && (!searched_ || (stops_ >= kTrackedStops && distance_m_ >= kTrackedDistance_m));
}

}  // namespace topogeo::localization
