// What a localizer works with: a map that grows and may stop growing and go on, or one that stays
// as it is whatever comes.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/localization/mapping/slam.hpp"
#include "topogeo/localization/tracking/map_localizer.hpp"
#include "topogeo/localization/tracking/mapping_session.hpp"

#include "background_optimizer.hpp"

namespace topogeo::localizer {

class ActiveSlam {
 public:
  /// Begins a map. The pool must outlive this.
  ActiveSlam(const localization::LocalizerConfig& config, localization::MatchPool& pool);
  /// What a stored map is for.
  enum class Use : std::uint8_t { kLocalize, kContinue };
  /// Localizes in a stored map or continues it; searches unless there is an initial pose.
  ActiveSlam(const localization::LocalizerConfig& config, localization::MatchPool& pool,
             std::shared_ptr<const localization::StoredMap> map, Use use,
             const std::optional<geometry::Pose2>& initial_pose);

  [[nodiscard]] localization::Slam& operator*() const { return *current_; }
  [[nodiscard]] localization::Slam* operator->() const { return current_.get(); }

  /// Null with a stored map that stays as it is for good.
  [[nodiscard]] localization::MappingSession* session() const { return session_; }
  /// What follows the robot in a map. Null while its stops become part of it one by one.
  [[nodiscard]] localization::MapLocalizer* map_localizer() const {
    return session_ != nullptr ? session_->follower() : map_localizer_;
  }
  /// Stops become part of the map, now or when their place in it is known.
  [[nodiscard]] bool mapping() const { return session_ != nullptr && session_->mapping(); }

 private:
  BackgroundOptimizer optimizer_;
  std::unique_ptr<localization::Slam> current_;
  localization::MappingSession* session_ = nullptr;      // current_, if it is one
  localization::MapLocalizer* map_localizer_ = nullptr;  // current_, if it is one
};

}  // namespace topogeo::localizer
