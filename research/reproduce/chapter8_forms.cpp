// Thesis, 8.3: the floor with a loop by each form of the fitness.
#include <algorithm>
#include <map>
#include <string>

#include "topogeo/support/format.hpp"

#include "reproduce/chapter8.hpp"

namespace topogeo::reproduce {
namespace {

constexpr const char* kFormsLoop = "loop";
constexpr const char* kFormsProductLoop = "loop, 10 m";

/// Why matches that would have closed the loop were refused: "match not accepted: few inliers (3),
/// ...".
std::string refusals(const Correction& correction) {
  std::map<std::string, int> counts;
  for (const localization::LoopDecision& decision : correction.slam->loop_decisions()) {
    if (decision.outcome != localization::LoopOutcome::kAccepted) {
      ++counts[localization::explanation(decision)];
    }
  }
  std::string text;
  for (const auto& [why, count] : counts) {
    text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", why, count);
  }
  return text.empty() ? "none was tried" : text;
}

}  // namespace

void forms_8_3(Report& report) {
  Table table{"The loop by each form of the fitness.",
              {"matching", "range (m)", "odometry noise", "backward correction", "solutions at",
               "forward, last off (m)", "last position off (m)", "mean error (m)", "time (s)",
               "matches refused"},
              {}};
  using localization::FitnessForm;
  struct Form {
    CorrectionKind kind;
    const char* drive = kFormsLoop;
  };
  for (const Form& form :
       {Form{{}}, Form{{.form = FitnessForm::kPrinted}}, Form{kSingleWalk},
        Form{{.kept = false, .form = FitnessForm::kPrinted}},
        Form{{.kept = false, .calibrated = false}}, Form{kProduct, kFormsProductLoop}}) {
    const Drive& drive = report.runs().drive(form.drive);
    const Correction& correction = report.runs().correction(form.drive, form.kind);
    const PoseErrors errors = pose_errors(correction.final_poses(), drive.truth);
    CorrectionKind forward_kind = form.kind;
    forward_kind.backward = false;
    const double forward_m =
        pose_errors(report.runs().correction(form.drive, forward_kind).final_poses(), drive.truth)
            .last_m;
    const auto kept =
        std::ranges::find_if(correction.kept, [](const auto& s) { return !s.empty(); });
    const auto at = std::ranges::find(correction.closed, true);
    const bool closed =
        form.kind.kept ? kept != correction.kept.end() : at != correction.closed.end();
    const auto where =
        form.kind.kept ? kept - correction.kept.begin() : at - correction.closed.begin();
    table.rows.push_back({matcher_text(correction.config), fmt::format("{:g}", drive.range_m),
                          form.kind.calibrated ? "calibrated" : "default",
                          form.kind.kept ? "distinct solutions kept" : "best one at once",
                          closed ? std::to_string(where + 1) : std::string("never"),
                          fmt::format("{:.2f}", forward_m), fmt::format("{:.2f}", errors.last_m),
                          fmt::format("{:.2f}", errors.mean_m),
                          fmt::format("{:.1f}", correction.wall_s), refusals(correction)});
    if (form.kind == CorrectionKind{}) {
      report.made_by(means_of(drive, correction));
      report.states("nodes and branches alone close the loop", closed);
      report.at_most("last position off, of that of the forward correction", errors.last_m,
                     forward_m, "m");
    } else {
      report.beside("last position off", errors.last_m, "m",
                    fmt::format("{}, {:g} m, {} noise, {}", matcher_text(correction.config),
                                drive.range_m, form.kind.calibrated ? "calibrated" : "default",
                                form.kind.kept ? "kept" : "at once"));
    }
  }
  report.add(std::move(table));
  report.note(
      "With the default noise of the odometry, 0.16 rad^2/m, every heading is as good as any other "
      "and corridors slide; with that of the replica's wheels (topogeo calibrate-odometry) nodes "
      "and branches close the loop without a gate.");
}

}  // namespace topogeo::reproduce
