// Verdicts about loops: conversion to and from Protobuf messages, and those of a report.
#include "topogeo/storage/loop_verdict.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "topogeo/storage/map_document.hpp"
#include "topogeo/storage/report.hpp"
#include "topogeo/support/format.hpp"

#include "map_conversions.hpp"

namespace topogeo::storage {
namespace {

constexpr int kCovarianceSize = 9;
constexpr std::size_t kMostText = 64;  // as in idl/trajectory.idl

/// The words of reports, in the order of LoopVerdict::Outcome.
constexpr std::array<std::string_view, LoopVerdict::kOutcomes> kOutcomeTexts = {
    "accepted", "match not accepted", "unconfirmed", "no consistent closing", "outvoted"};

double checked(double value, const char* what) {
  if (std::isfinite(value)) return value;
  throw std::runtime_error(fmt::format("{} of a loop: expected a finite number", what));
}

LoopVerdict verdict_of(const LoopCandidate& candidate) {
  const auto outcome = std::ranges::find(kOutcomeTexts, candidate.outcome);
  if (outcome == kOutcomeTexts.end()) {
    throw std::runtime_error("unknown outcome '" + candidate.outcome + "'");
  }
  LoopVerdict verdict;
  verdict.step = candidate.step;
  verdict.earlier_id = candidate.earlier_id;
  verdict.later_id = candidate.later_id;
  verdict.outcome = static_cast<LoopVerdict::Outcome>(outcome - kOutcomeTexts.begin());
  verdict.explanation = candidate.outcome;
  if (verdict.outcome == LoopVerdict::Outcome::kGate)
    verdict.explanation += ": " + candidate.reason;
  verdict.source = candidate.source;
  verdict.T_earlier_later = candidate.T_earlier_later;
  verdict.T_predicted = candidate.T_predicted;
  // The report has one deviation over both directions.
  const double variance_m2 = candidate.predicted_sigma_m * candidate.predicted_sigma_m / 2.0;
  verdict.predicted_covariance =
      Eigen::Vector3d(variance_m2, variance_m2,
                      candidate.predicted_sigma_rad * candidate.predicted_sigma_rad)
          .asDiagonal();
  verdict.correction_m = candidate.correction_m;
  verdict.correction_rad = candidate.correction_rad;
  verdict.fitness = candidate.fitness;
  verdict.probability = candidate.probability;
  return verdict;
}

bool is_same(const LoopVerdict& verdict, const topomap::LoopClosure& loop) {
  constexpr double kRounding = 1e-4;  // numbers of a report are rounded
  const geometry::Pose2& a = verdict.T_earlier_later;
  const geometry::Pose2& b = loop.T_earlier_later;
  return verdict.outcome == LoopVerdict::Outcome::kAccepted &&
         verdict.earlier_id == loop.earlier_id && verdict.later_id == loop.later_id &&
         (a.position_m() - b.position_m()).norm() < kRounding &&
         std::fabs(a.theta_rad - b.theta_rad) < kRounding;
}

bool is_of(const std::vector<LoopVerdict>& verdicts, const MapDocument& document) {
  return std::ranges::all_of(document.loop_closures, [&](const topomap::LoopClosure& loop) {
    return std::ranges::any_of(verdicts,
                               [&](const LoopVerdict& verdict) { return is_same(verdict, loop); });
  });
}

}  // namespace

void to_proto(const LoopVerdict& verdict, proto::LoopVerdict* out) {
  out->set_step(verdict.step);
  out->set_earlier_id(verdict.earlier_id);
  out->set_later_id(verdict.later_id);
  out->set_outcome(static_cast<proto::LoopOutcome>(verdict.outcome));
  out->set_explanation(verdict.explanation);
  out->set_source(verdict.source);
  to_proto(verdict.T_earlier_later, out->mutable_t_earlier_later());
  to_proto(verdict.T_predicted, out->mutable_t_predicted());
  for (int i = 0; i < kCovarianceSize; ++i) {
    out->add_predicted_covariance(verdict.predicted_covariance(i / 3, i % 3));
  }
  out->set_correction_m(verdict.correction_m);
  out->set_correction_rad(verdict.correction_rad);
  out->set_fitness(verdict.fitness);
  out->set_probability(verdict.probability);
}

LoopVerdict from_proto(const proto::LoopVerdict& in) {
  if (in.predicted_covariance_size() != kCovarianceSize ||
      !proto::LoopOutcome_IsValid(in.outcome()) || in.explanation().size() > kMostText ||
      in.source().size() > kMostText) {
    throw std::runtime_error("a verdict about a loop is damaged");
  }
  LoopVerdict verdict;
  verdict.step = in.step();
  verdict.earlier_id = in.earlier_id();
  verdict.later_id = in.later_id();
  verdict.outcome = static_cast<LoopVerdict::Outcome>(in.outcome());
  verdict.explanation = in.explanation();
  verdict.source = in.source();
  verdict.T_earlier_later = from_proto(in.t_earlier_later(), "verdict");
  verdict.T_predicted = from_proto(in.t_predicted(), "prediction of a verdict");
  for (int i = 0; i < kCovarianceSize; ++i) {
    verdict.predicted_covariance(i / 3, i % 3) =
        checked(in.predicted_covariance(i), "predicted covariance");
  }
  verdict.correction_m = checked(in.correction_m(), "correction");
  verdict.correction_rad = checked(in.correction_rad(), "turn");
  verdict.fitness = checked(in.fitness(), "fitness");
  verdict.probability = checked(in.probability(), "probability");
  return verdict;
}

void check_verdicts(const std::vector<LoopVerdict>& verdicts, std::size_t map_count) {
  for (const LoopVerdict& verdict : verdicts) {
    if (verdict.earlier_id < map_count && verdict.later_id < map_count) continue;
    throw std::runtime_error(
        fmt::format("verdict about a loop from {} to {}: expected ids below {}", verdict.earlier_id,
                    verdict.later_id, map_count));
  }
}

void add_verdicts_of_report(MapDocument& document, const std::filesystem::path& map_file) {
  if (!document.loop_verdicts.empty()) return;
  const std::filesystem::path report = map_file.parent_path() / "report.json";
  std::error_code none;
  if (!std::filesystem::is_regular_file(report, none)) return;
  try {
    std::vector<LoopVerdict> verdicts;
    for (const LoopCandidate& candidate : read_loop_candidates(report)) {
      verdicts.push_back(verdict_of(candidate));
    }
    check_verdicts(verdicts, document.local_maps.size());
    if (is_of(verdicts, document)) document.loop_verdicts = std::move(verdicts);
  } catch (const std::runtime_error&) {  // no report of this map
  }
}

}  // namespace topogeo::storage
