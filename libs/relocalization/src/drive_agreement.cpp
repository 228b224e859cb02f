#include "drive_agreement.hpp"

#include "topogeo/slam/loop/loop_config.hpp"

namespace topogeo::localization {

namespace {

// Beyond this path, earlier stops are too uncertain relative to the last one.
constexpr double kRemembered_m = 8.0;

}  // namespace

void DriveAgreement::add(bool accepted, double confidence) {
  agreed_.push_back(
      {path_m_, accepted ? AgreementWeights::kPassed : AgreementWeights::kDoubtful * confidence});
  while (path_m_ - agreed_.front().path_m > kRemembered_m) agreed_.pop_front();
}

void DriveAgreement::contradict() {
  if (!agreed_.empty()) agreed_.pop_front();
}

bool DriveAgreement::enough() const {
  return weight() >= AgreementWeights::kWantedAnywhere &&
         agreed_.back().path_m - agreed_.front().path_m >= AgreementWeights::kLeastSpread_m;
}

double DriveAgreement::weight() const {
  double sum = 0.0;
  for (const Agreed& agreed : agreed_) {
    if (path_m_ - agreed.path_m <= kRemembered_m) sum += agreed.weight;
  }
  return sum;
}

}  // namespace topogeo::localization
