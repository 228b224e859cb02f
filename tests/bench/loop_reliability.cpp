#include "loop_reliability.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <ostream>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "topogeo/pipeline/reliability.hpp"
#include "topogeo/support/format.hpp"

namespace topogeo::bench {

using geometry::Pose2;
using localization::LoopDecision;
using localization::LoopEvidence;
using localization::LoopTerms;
using pipeline::Reliability;

namespace {

constexpr double kRight_m = 0.5;
constexpr double kRight_rad = 10.0 * std::numbers::pi / 180.0;
constexpr double kRidge = 1e-3;  // of the mean log likelihood, whose terms are about one
constexpr int kNewtonSteps = 60;

using Terms = Eigen::Matrix<double, localization::kLoopTerms, 1>;

Terms terms_of(const LoopEvidence& evidence) {
  const LoopTerms terms = localization::loop_terms(evidence);
  return Eigen::Map<const Terms>(terms.data());
}

std::string recording_of(const std::string& log) {
  return log.substr(0, log.find('/'));
}

}  // namespace

std::vector<JudgedDecision> judged_decisions(
    std::span<const LoopDecision> decisions,
    const std::vector<std::optional<Pose2>>& T_world_stop) {
  std::vector<JudgedDecision> judged;
  for (const LoopDecision& decision : decisions) {
    const std::optional<Pose2>& earlier = T_world_stop[decision.earlier_id];
    const std::optional<Pose2>& later = T_world_stop[decision.later_id];
    if (!earlier || !later || decision.evidence.kind == LoopEvidence::Kind::kNone) continue;
    const Eigen::Vector3d off =
        geometry::difference(decision.T_earlier_later, geometry::between(*earlier, *later));
    judged.push_back(
        {decision, off.head<2>().norm() <= kRight_m && std::fabs(off.z()) <= kRight_rad});
  }
  return judged;
}

LoopTerms fitted_coefficients(std::span<const JudgedLog> logs,
                              std::optional<std::size_t> left_out) {
  Terms beta = Terms::Zero();
  for (int step = 0; step < kNewtonSteps; ++step) {
    Eigen::Matrix<double, localization::kLoopTerms, localization::kLoopTerms> hessian =
        kRidge * decltype(hessian)::Identity();
    Terms gradient = -kRidge * beta;
    for (std::size_t i = 0; i < logs.size(); ++i) {
      if (left_out && recording_of(logs[i].name) == recording_of(logs[*left_out].name)) continue;
      if (logs[i].decisions.empty()) continue;
      const double weight = 1.0 / static_cast<double>(logs[i].decisions.size());
      for (const JudgedDecision& judged : logs[i].decisions) {
        const Terms x = terms_of(judged.decision.evidence);
        const double p = 1.0 / (1.0 + std::exp(-beta.dot(x)));
        gradient += weight * ((judged.right ? 1.0 : 0.0) - p) * x;
        hessian += weight * p * (1.0 - p) * x * x.transpose();
      }
    }
    const Terms change = hessian.ldlt().solve(gradient);
    beta += change * std::min(1.0, 3.0 / (1e-12 + change.norm()));
    if (change.norm() < 1e-10) break;
  }
  LoopTerms coefficients{};
  Eigen::Map<Terms>(coefficients.data()) = beta;
  return coefficients;
}

void print_reliability(std::ostream& out, std::span<const JudgedLog> logs) {
  const auto print_coefficients = [&](const std::string& name, const LoopTerms& coefficients) {
    out << fmt::format("| {} |", name);
    for (const double c : coefficients) out << fmt::format(" {:.2f} |", c);
    out << '\n';
  };
  out << "\n| coefficients |\n|---|\n";
  print_coefficients("all logs", fitted_coefficients(logs, std::nullopt));
  Reliability library;
  Reliability left_out;
  Reliability recorded;
  std::string rows;
  for (std::size_t i = 0; i < logs.size(); ++i) {
    const LoopTerms coefficients = fitted_coefficients(logs, i);
    const bool again = std::any_of(
        logs.begin(), logs.begin() + static_cast<std::ptrdiff_t>(i),
        [&](const JudgedLog& log) { return recording_of(log.name) == recording_of(logs[i].name); });
    if (!again) print_coefficients("without " + recording_of(logs[i].name), coefficients);
    Reliability of_log;
    for (const JudgedDecision& judged : logs[i].decisions) {
      const LoopEvidence& evidence = judged.decision.evidence;
      library.add(judged.decision.probability, judged.right);
      const double probability = localization::loop_probability(evidence, coefficients);
      left_out.add(probability, judged.right);
      if (logs[i].recorded) recorded.add(probability, judged.right);
      of_log.add(probability, judged.right);
    }
    rows += fmt::format("| {} | {} | {} | {:.4f} | {:.4f} |\n", logs[i].name, of_log.count(),
                        of_log.count() - of_log.right(), of_log.brier(), of_log.log_loss());
  }
  out << "\n| log left out | decisions | wrong | Brier score | log loss |\n|---|---|---|---|---|\n"
      << rows;
  out << "\n| probability | all decisions | stated, fitted without the log | right | recorded logs "
         "| stated, fitted without the log | right | all decisions | stated by the library | right "
         "|\n|---|---|---|---|---|---|---|---|---|---|\n";
  for (std::size_t i = 0; i < Reliability::kTenths; ++i) {
    out << fmt::format("| {:.1f} to {:.1f} ", 0.1 * static_cast<double>(i),
                       0.1 * static_cast<double>(i + 1));
    for (const Reliability* of : {&left_out, &recorded, &library}) {
      const Reliability::Tenth& tenth = of->tenths()[i];
      out << fmt::format("| {} | {:.3f} | {:.3f} ", tenth.count, tenth.mean_stated(),
                         tenth.share_right());
    }
    out << "|\n";
  }
  out << fmt::format(
      "\n{} decisions; Brier score {:.4f} without the log, {:.4f} by the library; log loss {:.4f}, "
      "{:.4f}\n",
      left_out.count(), left_out.brier(), library.brier(), left_out.log_loss(), library.log_loss());
}

void write_decisions(std::ostream& out, std::span<const JudgedLog> logs) {
  out << "log,right,outcome,source,kind,fitness,doubt,overlap,inliers,rivalry,weakest,surprise,"
         "agreement,"
         "rival,contradicted,probability\n";
  for (const JudgedLog& log : logs) {
    for (const JudgedDecision& judged : log.decisions) {
      const LoopDecision& d = judged.decision;
      const LoopEvidence& e = d.evidence;
      out << fmt::format(
          "{},{:d},{},{},{},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.3f},{:.3f},"
          "{:d},{:.5f}\n",
          log.name, judged.right, localization::to_string(d.outcome),
          localization::to_string(d.source), static_cast<int>(e.kind), e.fitness, e.doubt,
          e.overlap, e.inliers, e.rivalry, e.weakest_sigma_m, e.surprise, e.agreement,
          e.rival_agreement, e.contradicted, d.probability);
    }
  }
}

}  // namespace topogeo::bench
