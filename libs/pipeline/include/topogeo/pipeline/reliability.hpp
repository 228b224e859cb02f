// Checks stated probabilities: their mean in each tenth against the share that came true.
#pragma once

#include <array>
#include <cstddef>

namespace topogeo::pipeline {

class Reliability {
 public:
  static constexpr std::size_t kTenths = 10;

  struct Tenth {
    std::size_t count = 0;
    std::size_t right = 0;
    double stated = 0.0;  ///< sum of the probabilities

    [[nodiscard]] double mean_stated() const;  ///< 0 without any, as share_right()
    [[nodiscard]] double share_right() const;
  };

  /// `probability` in [0, 1].
  void add(double probability, bool right);

  /// Decisions with probabilities in [i / 10, (i + 1) / 10); 1 counts with the last.
  [[nodiscard]] const std::array<Tenth, kTenths>& tenths() const { return tenths_; }
  [[nodiscard]] std::size_t count() const;
  [[nodiscard]] std::size_t right() const;
  /// Mean squared difference from the truth; 0 without any, as log_loss().
  [[nodiscard]] double brier() const;
  /// Mean of -log of the probability of the truth, with a floor of 1e-9.
  [[nodiscard]] double log_loss() const;

 private:
  std::array<Tenth, kTenths> tenths_{};
  double squares_ = 0.0;
  double losses_ = 0.0;
};

}  // namespace topogeo::pipeline
