// Which places of a recorded log are recognized, and how far covariances can be trusted.
//
//   topogeo_loops [--config FILE] [--thin N] [--jobs J] [--data FOLDER] LOG...
//
// Maps NAME.clf.gz of the folder and compares it with NAME.ref.tum. A stop revisits a place when
// it is within 2 m and 57 degrees of a stop 30 or more older, by the reference.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <thread>
#include <vector>

#include <Eigen/LU>
#include <time.h>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/localization/mapping/localizer.hpp"
#include "topogeo/localization/matching/matcher.hpp"
#include "topogeo/localization/matching/refinement.hpp"
#include "topogeo/pipeline/config.hpp"
#include "topogeo/pipeline/local_mapper.hpp"
#include "topogeo/pipeline/trajectory_error.hpp"
#include "topogeo/storage/relations.hpp"
#include "topogeo/storage/tum.hpp"
#include "topogeo/topomap/trajectory.hpp"

#include "recordings.hpp"

namespace {

using namespace topogeo;
using geometry::Pose2;
using localization::LoopDecision;
using localization::LoopOutcome;
using localization::PoseGraphEdge;

struct Mean {
  double sum = 0.0;
  std::size_t n = 0;
  void add(double v) {
    sum += v;
    ++n;
  }
  [[nodiscard]] double value() const { return n > 0 ? sum / static_cast<double>(n) : 0.0; }
};

// Answers like InProcessPool and keeps all answers.
class RecordingPool : public localization::MatchPool {
 public:
  void add_map(std::shared_ptr<const topomap::LocalMap> map) override {
    pool_.add_map(std::move(map));
  }
  std::vector<localization::MatchResult> match(
      std::span<const localization::MatchTask> tasks) override {
    auto results = pool_.match(tasks);
    for (std::size_t i = 0; i < results.size(); ++i) {
      if (out != nullptr) write(tasks[i], results[i]);
    }
    return results;
  }
  std::FILE* out = nullptr;

 private:
  void write(const localization::MatchTask& t, const localization::MatchResult& r) const {
    const Pose2 T = r.covariance.isZero(0.0) ? r.T_reference_query
                                             : localization::without_prior(
                                                   r.T_reference_query, r.covariance,
                                                   {t.T_reference_query, t.covariance.inverse()});
    std::fprintf(out, "%u %u %.9g %.9g %.9g", t.query_map_id, t.reference_map_id, T.x_m, T.y_m,
                 T.theta_rad);
    for (int i = 0; i < 9; ++i) std::fprintf(out, " %.9g", r.covariance(i));
    std::fprintf(out, " %d %d %.6g %.6g %.6g %.6g %.6g %.6g", static_cast<int>(r.verdict),
                 static_cast<int>(r.reason), r.overlap, r.inliers, r.violations, r.residual_rms_m,
                 r.scan_fitness, r.second.fitness / std::max(1e-9, r.fitness));
    std::fprintf(out, " %.9g %.9g %.9g", t.T_reference_query.x_m, t.T_reference_query.y_m,
                 t.T_reference_query.theta_rad);
    for (int i = 0; i < 9; ++i) std::fprintf(out, " %.9g", t.covariance(i));
    std::fprintf(out, "\n");
  }
  localization::InProcessPool pool_;
};

struct LoopFigures {
  std::string name;
  std::size_t scans = 0, stops = 0, revisits = 0, tried = 0, accepted = 0, wrong = 0;
  std::map<std::string, std::array<std::size_t, 3>> outcomes;  // right, near, wrong
  pipeline::TrajectoryError error;
  std::optional<pipeline::RelationsError> relations;
  Mean triangles, predictions, sequential, loops;
  Mean prediction_error_m, prediction_sigma_m;
  double local_mapper_s = 0.0, localizer_s = 0.0;
  std::uint64_t tasks = 0;
  localization::SlamCounts counts;
};

double thread_cpu_s() {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double mahalanobis2(const Eigen::Vector3d& e, const Eigen::Matrix3d& c) {
  return e.dot(c.inverse() * e);
}

void measure_triangles(const localization::PoseGraph& graph, LoopFigures& f) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, const PoseGraphEdge*> matches;
  for (const PoseGraphEdge& e : graph.edges()) {
    if (e.kind == localization::EdgeKind::kSequential) matches[{e.from, e.to}] = &e;
  }
  for (const auto& [key, ik] : matches) {
    for (std::uint32_t j = key.first + 1; j < key.second; ++j) {
      const auto ij = matches.find({key.first, j});
      const auto jk = matches.find({j, key.second});
      if (ij == matches.end() || jk == matches.end()) continue;
      const Pose2 T = ij->second->T_from_to * jk->second->T_from_to;
      const Eigen::Matrix3d c =
          geometry::compose_covariance(ij->second->T_from_to, ij->second->calibrated,
                                       jk->second->T_from_to, jk->second->calibrated) +
          ik->calibrated;
      f.triangles.add(mahalanobis2(geometry::difference(T, ik->T_from_to), c));
    }
  }
}

// How far predictions over a path are off, against their covariance.
void print_predictions(const localization::PoseGraph& graph,
                       const std::vector<std::optional<Pose2>>& truth, const std::string& name) {
  const std::size_t n = truth.size();
  std::vector<double> path_m(n, 0.0);
  for (std::size_t i = 1; i < n; ++i) {
    path_m[i] =
        path_m[i - 1] + (graph.poses()[i].position_m() - graph.poses()[i - 1].position_m()).norm();
  }
  const std::vector<double> lengths{2, 5, 10, 20, 50, 100, 200, 400};
  std::vector<Mean> error2(lengths.size()), sigma2(lengths.size()), heading2(lengths.size()),
      sigma_heading2(lengths.size()), d2(lengths.size());
  for (std::uint32_t b = 0; b < n; b += 3) {
    if (!truth[b]) continue;
    const auto relative = graph.predict_from(b, {});
    std::size_t k = 0;
    for (std::uint32_t a = b; a-- > 0 && k < lengths.size();) {
      if (path_m[b] - path_m[a] < lengths[k]) continue;
      if (!truth[a]) continue;
      const Pose2 T = geometry::between(*truth[b], *truth[a]);
      const Eigen::Vector3d e = geometry::difference(relative[a].T_a_b, T);
      const Eigen::Matrix3d& c = relative[a].covariance;
      error2[k].add(e.head<2>().squaredNorm());
      heading2[k].add(e.z() * e.z());
      sigma2[k].add(c(0, 0) + c(1, 1));
      sigma_heading2[k].add(c(2, 2));
      d2[k].add(mahalanobis2(e, c));
      ++k;
    }
  }
  for (std::size_t k = 0; k < lengths.size(); ++k) {
    if (d2[k].n == 0) continue;
    std::printf("  %-12s %4.0f m: error %.3f m %.4f rad, sigma %.3f m %.4f rad, d2 %.2f (%zu)\n",
                name.c_str(), lengths[k], std::sqrt(error2[k].value()),
                std::sqrt(heading2[k].value()), std::sqrt(sigma2[k].value()),
                std::sqrt(sigma_heading2[k].value()), d2[k].value(), d2[k].n);
  }
}

LoopFigures run(const bench::Recording& recording, const pipeline::Config& config,
                const std::optional<std::string>& relations, bool verbose) {
  LoopFigures f;
  f.name = recording.name;
  f.scans = recording.scans.size();
  pipeline::LocalMapper mapper(config.local_mapper, "robot");
  std::vector<std::shared_ptr<const topomap::LocalMap>> maps;
  std::map<std::int64_t, Pose2> truth_at;
  const double start_s = thread_cpu_s();
  for (std::size_t i = 0; i < recording.scans.size(); ++i) {
    if (recording.T_world_robot[i])
      truth_at[recording.scans[i].stamp_ns] = *recording.T_world_robot[i];
    if (auto map = mapper.add(recording.scans[i])) {
      maps.push_back(std::make_shared<const topomap::LocalMap>(std::move(*map)));
    }
  }
  if (auto map = mapper.finish()) {
    maps.push_back(std::make_shared<const topomap::LocalMap>(std::move(*map)));
  }
  const double mapped_s = thread_cpu_s();
  RecordingPool pool;
  if (const char* folder = std::getenv("DUMP")) {
    std::string file = f.name;
    std::replace(file.begin(), file.end(), '/', '_');
    pool.out = std::fopen((std::string(folder) + "/" + file + ".matches").c_str(), "w");
    std::FILE* odo = std::fopen((std::string(folder) + "/" + file + ".stops").c_str(), "w");
    for (const auto& map : maps) {
      const auto found = truth_at.find(map->stamp_ns);
      const Pose2 T = found == truth_at.end() ? Pose2{} : found->second;
      const auto o = map->id == 0
                         ? localization::UncertainPose{}
                         : localization::odometry_between_stops(maps[map->id - 1]->T_odom_robot,
                                                                *map, config.localizer.odometry);
      std::fprintf(odo, "%u %d %.9g %.9g %.9g %.9g %.9g %.9g %.9g %.9g %.9g\n", map->id,
                   found != truth_at.end(), T.x_m, T.y_m, T.theta_rad, o.T_a_b.x_m, o.T_a_b.y_m,
                   o.T_a_b.theta_rad, o.covariance(0, 0), o.covariance(1, 1), o.covariance(2, 2));
    }
    std::fclose(odo);
  }
  localization::Localizer localizer(config.localizer, pool);
  for (const auto& map : maps) localizer.add(map);
  localizer.finish();
  if (pool.out != nullptr) std::fclose(pool.out);
  f.local_mapper_s = mapped_s - start_s;
  f.localizer_s = thread_cpu_s() - mapped_s;
  f.tasks = localizer.counts().tasks;
  f.stops = maps.size();

  const std::size_t n = maps.size();
  std::vector<std::optional<Pose2>> truth(n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto found = truth_at.find(maps[i]->stamp_ns);
    if (found != truth_at.end()) truth[i] = found->second;
  }
  std::set<std::pair<std::uint32_t, std::uint32_t>> tried, accepted, outvoted;
  for (const LoopDecision& d : localizer.loop_decisions()) {
    const std::pair key{d.earlier_id, d.later_id};
    tried.insert(key);
    if (d.outcome == LoopOutcome::kAccepted) accepted.insert(key);
    if (d.outcome == LoopOutcome::kOutvoted) {
      outvoted.insert(key);
      accepted.erase(key);
    }
    if (!truth[d.earlier_id] || !truth[d.later_id]) continue;
    const Pose2 T = geometry::between(*truth[d.earlier_id], *truth[d.later_id]);
    const Eigen::Vector3d e = geometry::difference(d.T_earlier_later, T);
    const double m = e.head<2>().norm();
    const double rad = std::fabs(e.z());
    if (std::getenv("ALL") != nullptr) {
      std::fprintf(stderr,
                   "%s: fit %.2f step %u: %u - %u %s %s: off %.2f %.2f m %.2f rad; correction %.2f "
                   "m; predicted off %.2f %.2f sigma %.2f %.2f %.2f\n",
                   f.name.c_str(), d.fitness, d.step, d.earlier_id, d.later_id,
                   localization::to_string(d.source), localization::explanation(d).c_str(), e.x(),
                   e.y(), rad, d.correction_m, geometry::difference(d.predicted.T_a_b, T).x(),
                   geometry::difference(d.predicted.T_a_b, T).y(),
                   std::sqrt(d.predicted.covariance(0, 0)), std::sqrt(d.predicted.covariance(1, 1)),
                   std::sqrt(d.predicted.covariance(2, 2)));
    }
    const std::size_t cls = m < 0.25 && rad < 0.09 ? 0 : (m < 0.6 && rad < 0.2 ? 1 : 2);
    ++f.outcomes[std::string(localization::to_string(d.source)) + " " +
                 localization::explanation(d)][cls];
    if (d.outcome == LoopOutcome::kAccepted && cls == 2) {
      const auto in_common = [&](const Pose2& T_earlier_later) {
        const auto reference =
            localization::make_reference(localization::extract_features(*maps[d.earlier_id]));
        const auto query = localization::extract_features(*maps[d.later_id]);
        const auto e2 = localization::evidence_at(reference, query, T_earlier_later);
        return e2.overlap * (e2.inliers - 2.0 * e2.violations);
      };
      const double here = in_common(d.T_earlier_later);
      const double there = in_common(T);
      if (there >= here) ++f.wrong;
      if (verbose) {
        std::fprintf(stderr,
                     "%s: %u - %u accepted (%s), off %.2f m %.2f rad, correction %.2f m, in common "
                     "%.2f, by the reference %.2f, predicted sigma %.2f %.2f\n",
                     f.name.c_str(), d.earlier_id, d.later_id, localization::to_string(d.source), m,
                     rad, d.correction_m, here, there, std::sqrt(d.predicted.covariance(0, 0)),
                     std::sqrt(d.predicted.covariance(1, 1)));
      }
    }
  }
  for (std::uint32_t b = 0; b < n; ++b) {
    bool near = false, was_tried = false, was_accepted = false;
    for (std::uint32_t a = 0; a + 30 < b && truth[b]; ++a) {
      if (!truth[a]) continue;
      const Pose2 T = geometry::between(*truth[a], *truth[b]);
      if (T.position_m().norm() >= 2.0 || std::fabs(T.theta_rad) >= 1.0) continue;
      near = true;
      was_tried |= tried.count({a, b}) > 0;
      was_accepted |= accepted.count({a, b}) > 0;
    }
    f.revisits += near;
    f.tried += near && was_tried;
    f.accepted += near && was_accepted;
    if (verbose && near && !was_accepted) {
      std::fprintf(stderr, "%s: stop %u not recognized (%s)\n", f.name.c_str(), b,
                   was_tried ? "tried" : "not tried");
    }
  }
  if (std::getenv("STEPS") != nullptr) {
    for (std::uint32_t i = 1; i < n; ++i) {
      if (!truth[i] || !truth[i - 1]) continue;
      const Pose2 T = geometry::between(*truth[i - 1], *truth[i]);
      const auto& poses = localizer.graph().poses();
      const Eigen::Vector3d e = geometry::difference(geometry::between(poses[i - 1], poses[i]), T);
      if (e.head<2>().norm() < 0.25 && std::fabs(e.z()) < 0.1) continue;
      std::fprintf(stderr, "%s: step %u off %.2f %.2f %.3f (moves %.2f m %.2f rad);",
                   f.name.c_str(), i, e.x(), e.y(), e.z(), T.position_m().norm(), T.theta_rad);
      for (const PoseGraphEdge& edge : localizer.graph().edges()) {
        if (edge.to != i || edge.from + 4 < i) continue;
        if (!truth[edge.from]) continue;
        const Eigen::Vector3d d =
            geometry::difference(edge.T_from_to, geometry::between(*truth[edge.from], *truth[i]));
        std::fprintf(stderr, " [%u k%d off %.2f %.2f %.3f sigma %.2f %.2f %.3f]", edge.from,
                     static_cast<int>(edge.kind), d.x(), d.y(), d.z(),
                     std::sqrt(edge.covariance(0, 0)), std::sqrt(edge.covariance(1, 1)),
                     std::sqrt(edge.covariance(2, 2)));
      }
      std::fprintf(stderr, "\n");
    }
  }
  measure_triangles(localizer.graph(), f);
  if (std::getenv("PATHS") != nullptr) print_predictions(localizer.graph(), truth, f.name);
  f.counts = localizer.counts();
  for (const PoseGraphEdge& e : localizer.graph().edges()) {
    if (!truth[e.from] || !truth[e.to]) continue;
    const Pose2 T = geometry::between(*truth[e.from], *truth[e.to]);
    const double d2 = mahalanobis2(geometry::difference(T, e.T_from_to), e.covariance);
    if (e.kind == localization::EdgeKind::kSequential) f.sequential.add(std::min(d2, 100.0));
    if (e.kind == localization::EdgeKind::kRevisit) f.loops.add(std::min(d2, 100.0));
  }
  for (const LoopDecision& d : localizer.loop_decisions()) {
    if (d.outcome == LoopOutcome::kOutvoted || !truth[d.earlier_id] || !truth[d.later_id]) continue;
    if (d.predicted.covariance.isZero(0.0)) continue;
    if (d.later_id < d.earlier_id + 30 || d.step != d.later_id) continue;
    const Pose2 T = geometry::between(*truth[d.earlier_id], *truth[d.later_id]);
    const Eigen::Vector3d e = geometry::difference(d.predicted.T_a_b, T);
    f.predictions.add(std::min(100.0, mahalanobis2(e, d.predicted.covariance)));
    f.prediction_error_m.add(e.head<2>().norm());
    f.prediction_sigma_m.add(std::sqrt(d.predicted.covariance.topLeftCorner<2, 2>().trace()));
  }
  std::vector<topomap::StampedPose> reference;
  for (std::size_t i = 0; i < recording.scans.size(); ++i) {
    if (!recording.T_world_robot[i]) continue;
    reference.push_back(
        {recording.scans[i].sequence, recording.scans[i].stamp_ns, *recording.T_world_robot[i]});
  }
  std::vector<topomap::LocalMap> local_maps;
  for (const auto& map : maps) local_maps.push_back(*map);
  const auto corrected = topomap::expand_trajectory(localizer.trajectory(), local_maps);
  if (reference.size() > 3) f.error = pipeline::trajectory_error(corrected, reference);
  if (relations) {
    f.relations = pipeline::relations_error(corrected, storage::read_relations(*relations));
  }
  return f;
}

void print(const LoopFigures& f) {
  const auto loop = f.error.loop ? f.error.loop->mean_m : 0.0;
  std::printf(
      "%-13s ate %.3f loop %.3f | rel %.4f %.4f | revisits %zu tried %zu accepted %zu wrong %zu | "
      "d2 tri %.2f "
      "(%zu) pred %.2f (%zu; err %.2f sigma %.2f) seq %.2f loops %.2f | in doubt %llu stops %zu "
      "tasks %llu cpu %.1f + %.1f\n",
      f.name.c_str(), f.error.rms_m, loop,
      f.relations && f.relations->all ? f.relations->all->mean_m : 0.0,
      f.relations && f.relations->far ? f.relations->far->mean_m : 0.0, f.revisits, f.tried,
      f.accepted, f.wrong, f.triangles.value(), f.triangles.n, f.predictions.value(),
      f.predictions.n, f.prediction_error_m.value(), f.prediction_sigma_m.value(),
      f.sequential.value(), f.loops.value(),
      static_cast<unsigned long long>(f.counts.steps_in_doubt), f.stops,
      static_cast<unsigned long long>(f.tasks), f.local_mapper_s, f.localizer_s);
  for (const auto& [name, counts] : f.outcomes) {
    std::printf("    %-45s right %zu near %zu wrong %zu\n", name.c_str(), counts[0], counts[1],
                counts[2]);
  }
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  command_line::Command app{"which places of a recorded log are recognized"};
  std::vector<std::string> names;
  std::string data = "../shared/data";
  std::string config_file;
  std::size_t jobs = 2;
  bool verbose = false;
  app.add_option("log", names, "NAME or NAME/N: every N-th scan of it")->type_name("NAME");
  app.add_option("--data", data, "folder of NAME.clf.gz and NAME.ref.tum");
  app.add_option("--config", config_file, "configuration file");
  app.add_option("--jobs", jobs, "logs at a time");
  app.add_flag("--verbose", verbose, "each wrong loop and each place that was not recognized");
  if (const auto exit_code = app.parse_or_report(argc, argv)) return *exit_code;
  try {
    const pipeline::Config config =
        pipeline::load_config(
            config_file.empty() ? std::nullopt : std::optional<std::filesystem::path>(config_file))
            .config;
    std::atomic<std::size_t> next = 0;
    std::vector<LoopFigures> results(names.size());
    std::mutex mutex;
    const auto work = [&] {
      for (std::size_t i = next++; i < names.size(); i = next++) {
        const std::size_t slash = names[i].find('/');
        const std::string stem = names[i].substr(0, slash);
        bench::Recording recording = bench::recorded(data + "/" + stem + ".clf.gz",
                                                     data + "/" + stem + ".ref.tum", config.log);
        if (slash != std::string::npos) {
          const std::size_t thin = std::stoul(names[i].substr(slash + 1));
          bench::Recording thinned{names[i], {}, {}};
          for (std::size_t k = 0; k < recording.scans.size(); k += thin) {
            thinned.scans.push_back(recording.scans[k]);
            thinned.T_world_robot.push_back(recording.T_world_robot[k]);
          }
          recording = std::move(thinned);
        }
        const std::string relations = data + "/" + stem + ".relations";
        results[i] = run(
            recording, config,
            std::filesystem::exists(relations) ? std::optional(relations) : std::nullopt, verbose);
        const std::scoped_lock lock(mutex);
        print(results[i]);
      }
    };
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < jobs; ++i) threads.emplace_back(work);
    for (std::thread& thread : threads) thread.join();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "topogeo_loops: %s\n", error.what());
    return 1;
  }
  return 0;
}
