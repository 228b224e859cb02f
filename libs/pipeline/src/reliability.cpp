#include "topogeo/pipeline/reliability.hpp"

#include <algorithm>
#include <cmath>

namespace topogeo::pipeline {

namespace {

double share(double part, std::size_t count) {
  return count == 0 ? 0.0 : part / static_cast<double>(count);
}

}  // namespace

double Reliability::Tenth::mean_stated() const {
  return share(stated, count);
}

double Reliability::Tenth::share_right() const {
  return share(static_cast<double>(right), count);
}

void Reliability::add(double probability, bool right) {
  constexpr double kLeast = 1e-9;
  const auto tenth =
      static_cast<std::size_t>(std::clamp(probability, 0.0, 1.0) * static_cast<double>(kTenths));
  Tenth& of = tenths_[std::min(kTenths - 1, tenth)];
  ++of.count;
  of.right += right ? 1 : 0;
  of.stated += probability;
  const double of_truth = right ? probability : 1.0 - probability;
  squares_ += (1.0 - of_truth) * (1.0 - of_truth);
  losses_ -= std::log(std::max(kLeast, of_truth));
}

std::size_t Reliability::count() const {
  std::size_t sum = 0;
  for (const Tenth& tenth : tenths_) sum += tenth.count;
  return sum;
}

std::size_t Reliability::right() const {
  std::size_t sum = 0;
  for (const Tenth& tenth : tenths_) sum += tenth.right;
  return sum;
}

double Reliability::brier() const {
  return share(squares_, count());
}

double Reliability::log_loss() const {
  return share(losses_, count());
}

}  // namespace topogeo::pipeline
