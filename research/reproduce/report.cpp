#include <utility>

#include "topogeo/support/atomic_file.hpp"

#include "reproduce/experiment.hpp"
#include "reproduce/tolerances.hpp"

namespace topogeo::reproduce {

Report::Report(std::filesystem::path folder, std::string experiment, SharedRuns& runs)
    : folder_(std::move(folder)), experiment_(std::move(experiment)), runs_(&runs) {}

void Report::show(std::string name, double measured, std::string unit) {
  values_.push_back(Value{.name = std::move(name), .unit = std::move(unit), .measured = measured});
}

void Report::beside(std::string name, double measured, std::string unit, std::string by) {
  values_.push_back(Value{
      .name = std::move(name), .unit = std::move(unit), .measured = measured, .by = std::move(by)});
}

void Report::compare(std::string name, double measured, double expected, std::string unit,
                     Relation relation, Origin origin) {
  const double tolerance = tolerance_of(experiment_, name);
  values_.push_back(Value{.name = std::move(name),
                          .unit = std::move(unit),
                          .measured = measured,
                          .expected = expected,
                          .relation = relation,
                          .tolerance = tolerance,
                          .origin = origin});
}

void Report::printed(std::string name, double measured, double expected, std::string unit) {
  compare(std::move(name), measured, expected, std::move(unit), Relation::kEqual, Origin::kPrinted);
}

void Report::worked_out(std::string name, double measured, double expected, std::string unit) {
  compare(std::move(name), measured, expected, std::move(unit), Relation::kEqual,
          Origin::kWorkedOut);
}

void Report::at_most(std::string name, double measured, double printed, std::string unit) {
  compare(std::move(name), measured, printed, std::move(unit), Relation::kSmaller,
          Origin::kPrinted);
}

void Report::at_least(std::string name, double measured, double printed, std::string unit) {
  compare(std::move(name), measured, printed, std::move(unit), Relation::kLarger, Origin::kPrinted);
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
