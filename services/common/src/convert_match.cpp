#include "topogeo/messaging/message.hpp"
#include "topogeo/service/conversions.hpp"

#include "convert.hpp"

namespace topogeo::service {

using detail::check;
using detail::check_bound;
using detail::finite;

namespace {

msg::GeneticParameters to_genetic(const localization::GeneticParameters& genetic) {
  msg::GeneticParameters out;
  out.individuals(genetic.individuals);
  out.generations(genetic.generations);
  out.crossover_rate(genetic.crossover_rate);
  out.mutation_rate(genetic.mutation_rate);
  out.elite(genetic.elite);
  out.branch_hypotheses(genetic.branch_hypotheses);
  out.resolution_m(genetic.resolution_m);
  out.resolution_rad(genetic.resolution_rad);
  out.finer_resolution_m(genetic.finer_resolution_m);
  out.finer_resolution_rad(genetic.finer_resolution_rad);
  return out;
}

localization::GeneticParameters from_genetic(const msg::GeneticParameters& genetic) {
  localization::GeneticParameters out;
  out.individuals = genetic.individuals();
  out.generations = genetic.generations();
  out.crossover_rate = finite(genetic.crossover_rate(), "genetic.crossover_rate");
  out.mutation_rate = finite(genetic.mutation_rate(), "genetic.mutation_rate");
  out.elite = genetic.elite();
  out.branch_hypotheses = genetic.branch_hypotheses();
  out.resolution_m = finite(genetic.resolution_m(), "genetic.resolution_m");
  out.resolution_rad = finite(genetic.resolution_rad(), "genetic.resolution_rad");
  out.finer_resolution_m = finite(genetic.finer_resolution_m(), "genetic.finer_resolution_m");
  out.finer_resolution_rad = finite(genetic.finer_resolution_rad(), "genetic.finer_resolution_rad");
  return out;
}

msg::MatchGate to_gate(const localization::GateConfig& gate) {
  msg::MatchGate out;
  out.smallest_overlap(gate.smallest_overlap);
  out.smallest_inliers(gate.smallest_inliers);
  out.largest_doubt(gate.largest_doubt);
  out.doubt_per_search_m(gate.doubt_per_search_m);
  out.largest_mahalanobis2(gate.largest_mahalanobis2);
  out.largest_ambiguity(gate.largest_ambiguity);
  return out;
}

localization::GateConfig from_gate(const msg::MatchGate& gate) {
  localization::GateConfig out;
  out.smallest_overlap = finite(gate.smallest_overlap(), "gate.smallest_overlap");
  out.smallest_inliers = finite(gate.smallest_inliers(), "gate.smallest_inliers");
  out.largest_doubt = finite(gate.largest_doubt(), "gate.largest_doubt");
  out.doubt_per_search_m = finite(gate.doubt_per_search_m(), "gate.doubt_per_search_m");
  out.largest_mahalanobis2 = finite(gate.largest_mahalanobis2(), "gate.largest_mahalanobis2");
  out.largest_ambiguity = finite(gate.largest_ambiguity(), "gate.largest_ambiguity");
  return out;
}

msg::MatchSolution to_solution(const localization::MatchSolution& solution) {
  msg::MatchSolution out;
  out.T_reference_query(to_msg(solution.T_reference_query));
  out.fitness(solution.fitness);
  return out;
}

localization::MatchSolution from_solution(const msg::MatchSolution& solution) {
  return {from_msg(solution.T_reference_query()), finite(solution.fitness(), "solution.fitness")};
}

msg::PlaceQuestion to_question(const localization::PlaceQuestion& question) {
  check_bound("places.points", question.points.size(), msg::kMaxPlacePoints);
  check_bound("places.pieces", question.pieces.size(), msg::kMaxPlacePieces);
  msg::PlaceQuestion out;
  out.field_hash(question.field_hash);
  out.wall_pieces(question.wall_pieces);
  out.margin_m(question.margin_m);
  out.first_heading(question.first_heading);
  out.headings(question.headings);
  for (const topomap::ScanPoint& point : question.points) {
    msg::PlacePoint& to = out.points().emplace_back();
    to.x_m(point.x_m);
    to.y_m(point.y_m);
  }
  for (const auto& piece : question.pieces) {
    msg::PlacePiece& to = out.pieces().emplace_back();
    to.map_id(piece.map_id);
    to.content_hash(piece.content_hash);
  }
  return out;
}

std::shared_ptr<const localization::PlaceQuestion> from_question(
    const msg::PlaceQuestion& question) {
  if (question.pieces().empty()) return nullptr;
  auto out = std::make_shared<localization::PlaceQuestion>();
  out->field_hash = question.field_hash();
  out->wall_pieces = question.wall_pieces();
  out->margin_m = finite(question.margin_m(), "places.margin_m");
  // The margin takes memory: no laser reaches a kilometre.
  constexpr double kWidestMargin_m = 1000.0;
  check(out->margin_m >= 0.0 && out->margin_m <= kWidestMargin_m, "places.margin_m", "0 to 1000");
  out->first_heading = question.first_heading();
  out->headings = question.headings();
  for (const msg::PlacePoint& point : question.points()) {
    out->points.push_back({static_cast<float>(finite(point.x_m(), "places.points")),
                           static_cast<float>(finite(point.y_m(), "places.points"))});
  }
  for (const msg::PlacePiece& piece : question.pieces()) {
    out->pieces.push_back({piece.map_id(), piece.content_hash()});
  }
  return out;
}

}  // namespace

msg::MatchTasks tasks_for(const MatchAddress& address) {
  msg::MatchTasks out;
  messaging::set_header(out, address.robot_id, address.stamp_ns, address.sequence_number);
  messaging::set_worker_id(out, address.worker_id);
  messaging::set_client_id(out, address.client_id);
  messaging::set_text(out.version(), address.version, "version");
  out.config_fingerprint(address.config_fingerprint);
  out.matcher_fingerprint(address.matcher_fingerprint);
  return out;
}

msg::MatchResults results_for(const MatchAddress& address) {
  msg::MatchResults out;
  messaging::set_header(out, address.robot_id, address.stamp_ns, address.sequence_number);
  messaging::set_client_id(out, address.client_id);
  messaging::set_worker_id(out, address.worker_id);
  return out;
}

msg::MatchTask to_msg(const localization::MatchTask& task, std::int64_t stamp_ns) {
  check_bound("initial_individuals", task.initial_individuals.size(), msg::kMaxInitialIndividuals);
  msg::MatchTask out;
  out.task_id(task.task_id);
  out.stamp_ns(stamp_ns);
  out.reference_map_id(task.reference_map_id);
  out.query_map_id(task.query_map_id);
  out.reference_hash(task.reference_hash);
  out.query_hash(task.query_hash);
  out.T_reference_query(to_msg(task.T_reference_query));
  out.covariance(to_msg(task.covariance));
  out.half_width_x_m(task.half_width.x());
  out.half_width_y_m(task.half_width.y());
  out.half_width_rad(task.half_width.z());
  out.genetic(to_genetic(task.genetic));
  out.fitness_form(static_cast<msg::FitnessForm>(task.fitness_form));
  out.evidence(static_cast<msg::MatchEvidence>(task.evidence));
  for (const geometry::Pose2& pose : task.initial_individuals) {
    out.initial_individuals().push_back(to_msg(pose));
  }
  out.solutions_wanted(task.solutions_wanted);
  out.gate(to_gate(task.gate));
  out.seed(task.seed);
  if (task.places) out.places(to_question(*task.places));
  return out;
}

localization::MatchTask from_msg(const msg::MatchTask& message) {
  check(message.fitness_form() <= msg::kFitnessTopologicalWeighted, "fitness_form", "0 to 3");
  check(message.evidence() <= msg::kEvidenceFitness, "evidence", "0 to 2");
  check(message.solutions_wanted() >= 1 && message.solutions_wanted() <= msg::kMaxSolutions,
        "solutions_wanted", "1 to 40");
  localization::MatchTask out;
  out.task_id = message.task_id();
  out.reference_map_id = message.reference_map_id();
  out.query_map_id = message.query_map_id();
  out.reference_hash = message.reference_hash();
  out.query_hash = message.query_hash();
  out.T_reference_query = from_msg(message.T_reference_query());
  out.covariance = from_msg(message.covariance());
  out.half_width = {finite(message.half_width_x_m(), "half_width_x_m"),
                    finite(message.half_width_y_m(), "half_width_y_m"),
                    finite(message.half_width_rad(), "half_width_rad")};
  out.genetic = from_genetic(message.genetic());
  out.fitness_form = static_cast<localization::FitnessForm>(message.fitness_form());
  out.evidence = static_cast<localization::MatchEvidence>(message.evidence());
  for (const msg::Pose2& pose : message.initial_individuals()) {
    out.initial_individuals.push_back(from_msg(pose));
  }
  out.solutions_wanted = message.solutions_wanted();
  out.gate = from_gate(message.gate());
  out.seed = message.seed();
  out.places = from_question(message.places());
  return out;
}

msg::MatchResult to_msg(const localization::MatchResult& result) {
  check_bound("solutions", result.solutions.size(), msg::kMaxSolutions);
  msg::MatchResult out;
  out.task_id(result.task_id);
  out.status(static_cast<msg::MatchStatus>(result.status));
  for (const localization::MatchSolution& solution : result.solutions) {
    out.solutions().push_back(to_solution(solution));
  }
  out.T_reference_query(to_msg(result.T_reference_query));
  out.covariance(to_msg(result.covariance));
  out.overlap(result.overlap);
  out.inliers(result.inliers);
  out.violations(result.violations);
  out.residual_rms_m(result.residual_rms_m);
  out.scan_fitness(result.scan_fitness);
  out.topological_fitness(result.topological_fitness);
  out.fitness(result.fitness);
  out.second(to_solution(result.second));
  out.evaluations(result.evaluations);
  out.seed(result.seed);
  out.verdict(static_cast<msg::MatchVerdict>(result.verdict));
  out.reason(static_cast<msg::MatchReason>(result.reason));
  return out;
}

localization::MatchResult from_msg(const msg::MatchResult& message) {
  check(message.status() <= msg::kMatchNothingInCommon, "status", "a result, no refusal");
  check(message.verdict() <= msg::kVerdictRejected, "verdict", "0 to 2");
  check(message.reason() <= msg::kReasonSecondSolution, "reason", "0 to 6");
  localization::MatchResult out;
  out.task_id = message.task_id();
  out.status = static_cast<localization::MatchStatus>(message.status());
  for (const msg::MatchSolution& solution : message.solutions()) {
    out.solutions.push_back(from_solution(solution));
  }
  out.T_reference_query = from_msg(message.T_reference_query());
  out.covariance = from_msg(message.covariance());
  out.overlap = finite(message.overlap(), "overlap");
  out.inliers = finite(message.inliers(), "inliers");
  out.violations = finite(message.violations(), "violations");
  out.residual_rms_m = finite(message.residual_rms_m(), "residual_rms_m");
  out.scan_fitness = finite(message.scan_fitness(), "scan_fitness");
  out.topological_fitness = finite(message.topological_fitness(), "topological_fitness");
  out.fitness = finite(message.fitness(), "fitness");
  out.second = from_solution(message.second());
  out.evaluations = message.evaluations();
  out.seed = message.seed();
  out.verdict = static_cast<localization::Verdict>(message.verdict());
  out.reason = static_cast<localization::Reason>(message.reason());
  return out;
}

}  // namespace topogeo::service
