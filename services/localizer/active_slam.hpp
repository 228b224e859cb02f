// What a localizer works with: a map that grows, or one that stays as it is and that the robot is
// followed in; and the way from the first to the second.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/localization/map_localizer.hpp"
#include "topogeo/localization/slam.hpp"

#include "background_optimizer.hpp"

namespace topogeo::localizer {

class ActiveSlam {
 public:
  using MapPointer = std::shared_ptr<const topomap::LocalMap>;

  /// Maps. The pool must outlive this.
  ActiveSlam(const localization::LocalizerConfig& config, localization::MatchPool& pool);
  /// Localizes in a stored map; searches unless there is an initial pose.
  ActiveSlam(const localization::LocalizerConfig& config, localization::MatchPool& pool,
             std::shared_ptr<const localization::StoredMap> map,
             const std::optional<geometry::Pose2>& initial_pose);

  [[nodiscard]] localization::Slam& operator*() const { return *current_; }
  [[nodiscard]] localization::Slam* operator->() const { return current_.get(); }

  /// Null while it maps.
  [[nodiscard]] localization::MapLocalizer* map_localizer() const { return map_localizer_; }
  /// A map was made until freeze(): what that has given is final, and stops since are no part of
  /// it.
  [[nodiscard]] bool frozen() const { return frozen_ != nullptr; }

  /// Takes what was mapped so far as the map to localize in; `maps` are its local maps. The robot
  /// is where it was. Throws std::logic_error unless it maps, and like MapLocalizer.
  void freeze(std::span<const MapPointer> maps);

 private:
  localization::LocalizerConfig config_;
  localization::MatchPool& pool_;
  BackgroundOptimizer optimizer_;
  std::unique_ptr<localization::Slam> current_;
  std::unique_ptr<localization::Slam> frozen_;
  localization::MapLocalizer* map_localizer_ = nullptr;
};

}  // namespace topogeo::localizer
