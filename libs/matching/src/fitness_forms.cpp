#include "topogeo/matching/fitness_forms.hpp"

#include <array>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>

#include "fitness_combined.hpp"

namespace topogeo::localization {
namespace {

constexpr std::size_t kFitnessForms = 4;  // values of FitnessForm

std::size_t index_of(FitnessForm form) {
  return static_cast<std::size_t>(form);
}

// Null for a form that no program added.
std::array<MakeFitness, kFitnessForms>& added_forms() {
  static std::array<MakeFitness, kFitnessForms> forms{};
  return forms;
}

bool is_built_in(FitnessForm form) {
  return form == FitnessForm::kCombined || form == FitnessForm::kTopological;
}

}  // namespace

void add_fitness_form(FitnessForm form, MakeFitness make) {
  added_forms().at(index_of(form)) = make;
}

bool has_fitness_form(FitnessForm form) {
  if (index_of(form) >= kFitnessForms) return false;
  return is_built_in(form) || added_forms()[index_of(form)] != nullptr;
}

std::vector<FitnessForm> fitness_forms() {
  std::vector<FitnessForm> forms;
  for (std::size_t i = 0; i < kFitnessForms; ++i) {
    const auto form = static_cast<FitnessForm>(i);
    if (has_fitness_form(form)) forms.push_back(form);
  }
  return forms;
}

const char* to_string(FitnessForm form) {
  switch (form) {
    case FitnessForm::kPrinted:
      return "printed";
    case FitnessForm::kTopological:
      return "topological";
    case FitnessForm::kTopologicalWeighted:
      return "topological_weighted";
    case FitnessForm::kCombined:
      break;
  }
  return "combined";
}

struct FitnessForms::Forms {
  CombinedFitness combined;
  std::array<std::unique_ptr<AddedFitness>, kFitnessForms> added;  // each made at its first use
  FitnessForm form = FitnessForm::kCombined;

  /// Null if the form is one of the product.
  [[nodiscard]] const AddedFitness* chosen_added() const {
    return is_built_in(form) ? nullptr : added[index_of(form)].get();
  }
};

FitnessForms::FitnessForms() : forms_(std::make_unique<Forms>()) {}
FitnessForms::FitnessForms(const Reference& reference, const MatchFeatures& query,
                           const MatchTask& task)
    : FitnessForms() {
  bind(reference, query, task);
}
FitnessForms::FitnessForms(FitnessForms&&) noexcept = default;
FitnessForms& FitnessForms::operator=(FitnessForms&&) noexcept = default;
FitnessForms::~FitnessForms() = default;

void FitnessForms::bind(const Reference& reference, const MatchFeatures& query,
                        const MatchTask& task) {
  const FitnessForm form = task.fitness_form;
  if (!has_fitness_form(form)) {
    throw std::invalid_argument(std::string("fitness form '") + to_string(form) +
                                "' is not built into this program");
  }
  forms_->form = form;
  forms_->combined.bind(reference, query, task);
  if (is_built_in(form)) return;
  std::unique_ptr<AddedFitness>& added = forms_->added[index_of(form)];
  if (!added) added = added_forms()[index_of(form)]();
  added->bind(reference, query, task);
}

const Fitness& FitnessForms::chosen() const {
  if (const AddedFitness* added = forms_->chosen_added()) return *added;
  if (forms_->form == FitnessForm::kTopological) return forms_->combined.topological();
  return forms_->combined;
}

double FitnessForms::of_maps(const geometry::Pose2& T_reference_query,
                             const geometry::SinCos& heading) const {
  if (const AddedFitness* added = forms_->chosen_added()) {
    return added->of_maps(T_reference_query, heading);
  }
  if (forms_->form == FitnessForm::kCombined) {
    return forms_->combined.of_maps(T_reference_query, heading);
  }
  return chosen().at(T_reference_query, heading);
}

FitnessForms::Parts FitnessForms::parts(const geometry::Pose2& T) const {
  const CombinedFitness& combined = forms_->combined;
  return {combined.scan()(T), combined.topological()(T), combined.prior()(T)};
}

const CombinedFitness& FitnessForms::combined() const {
  return forms_->combined;
}

}  // namespace topogeo::localization
