// Adds the published algorithm and the published forms of the fitness to each program that is
// linked with this object, before its main() (research/CMakeLists.txt).
#include "topogeo/fitness/published_forms.hpp"
#include "topogeo/thesis/thesis_mode.hpp"

namespace {

[[maybe_unused]] const bool kAdded = [] {
  topogeo::localization::add_published_forms();
  topogeo::localization::add_thesis_mode();
  return true;
}();

}  // namespace
