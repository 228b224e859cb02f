// The grade of a map, from the reasons against it.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace topogeo::results {

inline constexpr const char* kGood = "good";
inline constexpr const char* kFair = "fair";
inline constexpr const char* kPoor = "poor";
inline constexpr const char* kUseless = "useless";

/// Lowers a grade and notes the reason.
class Judgement {
 public:
  void fair(std::string reason) {
    if (grade_ == kGood) grade_ = kFair;
    reasons_.push_back(std::move(reason));
  }
  void poor(std::string reason) {
    incomplete(std::move(reason));
    unreliable_ = true;
  }
  /// Poor, but usually right as far as it goes.
  void incomplete(std::string reason) {
    grade_ = kPoor;
    reasons_.push_back(std::move(reason));
  }
  /// Right in its shape, but perhaps not in its size: the first reason of a map that is fair.
  void of_unknown_scale(std::string reason) {
    if (grade_ == kGood) grade_ = kFair;
    reasons_.insert(grade_ == kFair ? reasons_.begin() : reasons_.end(), std::move(reason));
  }
  void useless(std::string reason) {
    grade_ = kUseless;
    unreliable_ = true;
    reasons_ = {std::move(reason)};
  }
  [[nodiscard]] const std::string& grade() const { return grade_; }
  [[nodiscard]] const std::vector<std::string>& reasons() const { return reasons_; }
  [[nodiscard]] bool unreliable() const { return unreliable_; }

 private:
  std::string grade_ = kGood;
  bool unreliable_ = false;
  std::vector<std::string> reasons_;
};

}  // namespace topogeo::results
