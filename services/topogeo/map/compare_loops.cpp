#include "map/compare_loops.hpp"

#include <exception>
#include <iostream>
#include <stdexcept>
#include <vector>

#include <nlohmann/json.hpp>

#include "topogeo/pipeline/loop_recall.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/storage/read_map.hpp"
#include "topogeo/storage/report.hpp"
#include "topogeo/storage/tum.hpp"
#include "topogeo/support/format.hpp"

namespace topogeo::cli {
namespace {

using pipeline::LoopOutcomeCounts;
using pipeline::LoopRecall;
using pipeline::Reliability;

std::vector<storage::LoopCandidate> read_candidates(const LoopComparison& comparison) {
  if (comparison.report) return storage::read_loop_candidates(*comparison.report);
  const std::filesystem::path beside = comparison.map.parent_path() / "report.json";
  if (!std::filesystem::exists(beside)) {
    throw std::runtime_error(fmt::format(
        "{}: does not exist; --loops reads the decisions on loops from the report of the run that "
        "made the map: name it with --report",
        beside.string()));
  }
  return storage::read_loop_candidates(beside);
}

LoopRecall recall_of(const LoopComparison& comparison) {
  try {
    const storage::MapDocument map = storage::read_map(comparison.map);
    const std::vector<storage::LoopCandidate> candidates = read_candidates(comparison);
    std::vector<topomap::StampedPose> reference =
        storage::read_trajectory_tum(comparison.reference);
    const geometry::Pose2 T_laser_robot = geometry::inverse(comparison.T_robot_laser);
    for (topomap::StampedPose& pose : reference) pose.pose = pose.pose * T_laser_robot;
    return pipeline::loop_recall(map.local_maps, reference, candidates, comparison.max_apart_ns);
  } catch (const std::invalid_argument& error) {  // from loop_recall, which does not know the files
    throw service::BadInputError(comparison.map.string() + " and " + comparison.reference.string() +
                                 ": " + error.what());
  } catch (const std::exception& error) {
    throw service::BadInputError(error.what());
  }
}

void print_text(const Reliability& reliability) {
  std::cout << fmt::format("\n{:<11} {:>10} {:>7} {:>6}\n", "probability", "decisions", "stated",
                           "right");
  for (std::size_t i = 0; i < Reliability::kTenths; ++i) {
    const Reliability::Tenth& tenth = reliability.tenths()[i];
    if (tenth.count == 0) continue;
    std::cout << fmt::format("{:.1f} to {:.1f}  {:>10} {:>7.3f} {:>6.3f}\n",
                             0.1 * static_cast<double>(i), 0.1 * static_cast<double>(i + 1),
                             tenth.count, tenth.mean_stated(), tenth.share_right());
  }
  std::cout << fmt::format("Brier score {:.4f}\n", reliability.brier());
}

void print_text(const LoopRecall& recall) {
  std::size_t rejected = 0;
  for (const auto& [reason, count] : recall.rejected()) rejected += count;
  std::cout << fmt::format("stops     {} with a reference pose\n", recall.stops)
            << fmt::format("revisits  {}\n", recall.revisits.size())
            << fmt::format("tried     {}\n", recall.tried())
            << fmt::format("accepted  {}\n", recall.accepted())
            << fmt::format("in view   {}, of them accepted {}\n", recall.in_view(),
                           recall.accepted_in_view())
            << fmt::format("wrong     {}\n", recall.wrong())
            << fmt::format("rejected  {} right decisions\n", rejected);
  if (recall.outcomes.empty()) return;
  std::cout << fmt::format("\n{:<10}  {:<44} {:>6} {:>6} {:>6}\n", "source", "outcome", "right",
                           "near", "wrong");
  for (const LoopOutcomeCounts& of : recall.outcomes) {
    std::cout << fmt::format("{:<10}  {:<44} {:>6} {:>6} {:>6}\n", of.source, of.outcome, of.right,
                             of.near, of.wrong);
  }
  print_text(recall.reliability);
}

nlohmann::ordered_json json_of(const Reliability& reliability) {
  nlohmann::ordered_json tenths = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < Reliability::kTenths; ++i) {
    const Reliability::Tenth& tenth = reliability.tenths()[i];
    tenths.push_back({{"from", static_cast<double>(i) / static_cast<double>(Reliability::kTenths)},
                      {"decisions", tenth.count},
                      {"stated", tenth.mean_stated()},
                      {"right", tenth.right}});
  }
  return {{"brier_score", reliability.brier()}, {"tenths", tenths}};
}

void print_json(const LoopRecall& recall) {
  nlohmann::ordered_json rejected = nlohmann::ordered_json::object();
  for (const auto& [reason, count] : recall.rejected()) rejected[reason] = count;
  nlohmann::ordered_json outcomes = nlohmann::ordered_json::array();
  for (const LoopOutcomeCounts& of : recall.outcomes) {
    outcomes.push_back({{"source", of.source},
                        {"outcome", of.outcome},
                        {"right", of.right},
                        {"near", of.near},
                        {"wrong", of.wrong}});
  }
  const nlohmann::ordered_json all = {
      {"stops", recall.stops},       {"revisits", recall.revisits.size()},
      {"tried", recall.tried()},     {"accepted", recall.accepted()},
      {"in_view", recall.in_view()}, {"accepted_in_view", recall.accepted_in_view()},
      {"wrong", recall.wrong()},     {"rejected", rejected},
      {"outcomes", outcomes},        {"reliability", json_of(recall.reliability)}};
  std::cout << all.dump() << '\n';
}

}  // namespace

void print_loops(const LoopComparison& comparison) {
  const LoopRecall recall = recall_of(comparison);
  if (comparison.json) {
    print_json(recall);
  } else {
    print_text(recall);
  }
}

}  // namespace topogeo::cli
