#include <utility>

#include "topogeo/support/atomic_file.hpp"

#include "reproduce/experiment.hpp"

namespace topogeo::reproduce {

Report::Report(std::filesystem::path folder, std::string experiment, SharedRuns& runs)
    : folder_(std::move(folder)), experiment_(std::move(experiment)), runs_(&runs) {}

void Report::show(std::string name, double measured, std::string unit) {
  add(Value{.name = std::move(name), .unit = std::move(unit), .measured = measured});
}

void Report::printed(std::string name, double measured, double expected, std::string unit,
                     double tolerance) {
  add(Value{std::move(name), std::move(unit), measured, expected, Relation::kEqual, tolerance,
            Origin::kPrinted});
}

void Report::worked_out(std::string name, double measured, double expected, std::string unit,
                        double tolerance) {
  add(Value{std::move(name), std::move(unit), measured, expected, Relation::kEqual, tolerance,
            Origin::kWorkedOut});
}

void Report::at_most(std::string name, double measured, double printed, std::string unit,
                     double tolerance) {
  add(Value{std::move(name), std::move(unit), measured, printed, Relation::kSmaller, tolerance,
            Origin::kPrinted});
}

void Report::at_least(std::string name, double measured, double printed, std::string unit,
                      double tolerance) {
  add(Value{std::move(name), std::move(unit), measured, printed, Relation::kLarger, tolerance,
            Origin::kPrinted});
}

void Report::states(std::string statement, bool holds) {
  printed(std::move(statement), holds ? 1.0 : 0.0, 1.0, "yes");
}

void Report::draw(const render::Figure& figure, const std::string& caption,
                  const std::string& part) {
  const std::uint32_t width_px = figure.panels.size() > 1 ? 1500 : 900;
  keep_picture(
      render::figure_picture(figure, render::PictureFormat::kPng, {.max_width_px = width_px}),
      caption, part);
}

void Report::keep_picture(const std::string& bytes, const std::string& caption,
                          const std::string& part) {
  const std::string file = experiment_ + (part.empty() ? "" : '_' + part) + ".png";
  support::write_file_atomically(folder_ / file, bytes);
  pictures_.push_back({file, caption});
}

}  // namespace topogeo::reproduce
