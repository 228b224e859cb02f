// All forms of the fitness for one pair of maps, reused from match to match to save allocations.
//
// The product has the combined and the topological form. A program may add others: `research/` has
// those of the publications.
#pragma once

#include <memory>
#include <vector>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/match.hpp"
#include "topogeo/matching/match_features.hpp"

namespace topogeo::localization {

// How well two local maps agree at a relative pose (Thesis, 6.2.5; docs/algorithms.md, "Fitness"):
// the quantity that the genetic search maximises. The forms share this interface; their headers
// describe them.

class Fitness {
 public:
  Fitness() = default;
  Fitness(const Fitness&) = default;
  Fitness& operator=(const Fitness&) = default;
  virtual ~Fitness() = default;

  /// Fitness in [0, 1] at T_reference_query, whose heading has the sine and cosine `heading`. No
  /// allocation.
  [[nodiscard]] virtual double at(const geometry::Pose2& T_reference_query,
                                  const geometry::SinCos& heading) const = 0;

  [[nodiscard]] double operator()(const geometry::Pose2& T_reference_query) const {
    return at(T_reference_query, geometry::sincos(T_reference_query.theta_rad));
  }
};

class CombinedFitness;

/// A form that a program adds.
class AddedFitness : public Fitness {
 public:
  /// The maps must outlive their use. Allocates only for a larger map than ever before.
  virtual void bind(const Reference& reference, const MatchFeatures& query,
                    const MatchTask& task) = 0;

  /// Like at(), but by the maps alone, without the odometry.
  [[nodiscard]] virtual double of_maps(const geometry::Pose2& T_reference_query,
                                       const geometry::SinCos& heading) const = 0;
};

using MakeFitness = std::unique_ptr<AddedFitness> (*)();

/// Adds a form to the program. Call it before the first match and before any threads start.
void add_fitness_form(FitnessForm form, MakeFitness make);

/// Whether the program has the form.
bool has_fitness_form(FitnessForm form);
/// The forms that the program has, ascending.
std::vector<FitnessForm> fitness_forms();

/// "combined", "topological", ...: the value of `match.fitness`.
const char* to_string(FitnessForm form);

class FitnessForms {
 public:
  /// bind() before use.
  FitnessForms();
  FitnessForms(const Reference& reference, const MatchFeatures& query, const MatchTask& task);
  FitnessForms(FitnessForms&& other) noexcept;
  FitnessForms& operator=(FitnessForms&& other) noexcept;
  ~FitnessForms();

  /// The maps must outlive their use. Allocates only for a larger map than ever before, and for a
  /// form that was not used before. Throws std::invalid_argument if the program lacks the form.
  void bind(const Reference& reference, const MatchFeatures& query, const MatchTask& task);

  /// The form that the task names.
  [[nodiscard]] const Fitness& chosen() const;

  /// Fitness by the maps alone, without an odometry prior.
  [[nodiscard]] double of_maps(const geometry::Pose2& T_reference_query,
                               const geometry::SinCos& heading) const;

  /// Factors of the combined form.
  struct Parts {
    double scan = 0.0;
    double topological = 0.0;
    double prior = 0.0;
  };
  [[nodiscard]] Parts parts(const geometry::Pose2& T_reference_query) const;

  [[nodiscard]] const CombinedFitness& combined() const;

 private:
  struct Forms;
  std::unique_ptr<Forms> forms_;
};

}  // namespace topogeo::localization
