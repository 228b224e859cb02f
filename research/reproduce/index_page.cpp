#include "reproduce/index_page.hpp"

#include <array>
#include <exception>

#include <nlohmann/json.hpp>

#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/markup.hpp"

namespace topogeo::reproduce {
namespace {

constexpr const char* kPictureFolder = "pictures/";

const char* origin_text(Origin origin) {
  return origin == Origin::kPrinted ? "printed" : "worked out";
}

const char* relation_text(Relation relation) {
  switch (relation) {
    case Relation::kShown:
      return "shown";
    case Relation::kEqual:
      return "equal";
    case Relation::kSmaller:
      return "smaller is better";
    case Relation::kLarger:
      return "larger is better";
  }
  return "unknown";
}

std::string values_html(const std::vector<Value>& values) {
  if (values.empty()) return "";
  std::string html =
      "<table><tr><th>value</th><th>here</th><th>published</th><th></th><th>tolerance</th>"
      "<th>verdict</th></tr>\n";
  for (const Value& value : values) {
    const bool compared = value.relation != Relation::kShown && value.expected.has_value();
    html += fmt::format(
        "<tr><td>{}{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td>{}</td><td "
        "class=\"n\">{}</td><td class=\"{}\">{}</td></tr>\n",
        support::escaped_markup(value.name),
        value.by.empty() ? "" : " <i>(beside, by " + support::escaped_markup(value.by) + ")</i>",
        text_of(value.measured, value.unit),
        value.expected ? text_of(*value.expected, value.unit) : "",
        !value.expected                      ? ""
        : value.unit == "yes"                ? "stated"
        : value.relation == Relation::kEqual ? origin_text(value.origin)
                                             : relation_text(value.relation),
        compared && value.tolerance > 1e-6 ? text_of(value.tolerance, value.unit) : "",
        compared ? to_string(verdict_of(value)) : "", compared ? to_string(verdict_of(value)) : "");
  }
  return html + "</table>\n";
}

std::string table_html(const Table& table) {
  std::string html = fmt::format("<p>{}</p><table><tr>", support::escaped_markup(table.title));
  for (const std::string& cell : table.header)
    html += "<th>" + support::escaped_markup(cell) + "</th>";
  html += "</tr>\n";
  for (const std::vector<std::string>& row : table.rows) {
    html += "<tr>";
    for (const std::string& cell : row)
      html += "<td class=\"n\">" + support::escaped_markup(cell) + "</td>";
    html += "</tr>\n";
  }
  return html + "</table>\n";
}

std::string row_html(const Outcome& outcome) {
  const Experiment& experiment = *outcome.experiment;
  std::string html = fmt::format(
      "<section id=\"{0}\"><h2>{1}, {2} <span class=\"{3}\">{3}</span></h2>\n<p>{4}</p>\n"
      "<p><b>{5}</b> ({0}, {6:.1f} s). Made by: {7}.</p>\n",
      support::escaped_markup(experiment.name), support::escaped_markup(experiment.publication),
      support::escaped_markup(experiment.number), to_string(outcome.verdict()),
      support::escaped_markup(experiment.caption), support::escaped_markup(outcome.verdict_text()),
      outcome.wall_s, support::escaped_markup(text_of(outcome.means)));
  html += values_html(outcome.values);
  for (const Table& table : outcome.tables) html += table_html(table);
  for (const std::string& note : outcome.notes)
    html += "<p>" + support::escaped_markup(note) + "</p>\n";
  for (const ReportPicture& picture : outcome.pictures) {
    html += fmt::format(
        "<figure><img src=\"{0}{1}\" alt=\"{1}\" loading=\"lazy\">"
        "<figcaption>{2}</figcaption></figure>\n",
        kPictureFolder, support::escaped_markup(picture.file),
        support::escaped_markup(picture.caption));
  }
  return html + "</section>\n";
}

constexpr const char* kPageHead = R"(<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>topogeo reproduce</title><style>
body { font-family: sans-serif; max-width: 1200px; margin: 1em auto; padding: 0 1em; color: #222; }
section { border-top: 1px solid #bbb; margin-top: 2em; }
table { border-collapse: collapse; margin: 0.6em 0; }
td, th { border: 1px solid #ccc; padding: 0.15em 0.6em; text-align: left; font-size: 0.9em; }
td.n { text-align: right; }
img { max-width: 100%; border: 1px solid #ddd; }
figure { margin: 1em 0; }
.equal { color: #005a9c; } .better { color: #0a7a2f; } .differs { color: #b02020; }
h2 span { font-size: 0.7em; }
</style></head><body>
<h1>Experiments, figures and tables of the publications</h1>
<p>Each row is a figure or table of a publication (see docs/algorithms.md), described in our words,
with what this program measures beside what is published. "Worked out" values follow from the scene
by the publication's equations. Verdicts are computed from the values and from tolerances that
were chosen before the run. A value "beside" was made by other means than the publication's; it
never counts in a verdict.</p>
)";

std::string summary_html(const std::vector<Outcome>& outcomes) {
  std::array<std::size_t, 3> count{};
  double wall_s = 0.0;
  for (const Outcome& outcome : outcomes) {
    ++count[static_cast<std::size_t>(outcome.verdict())];
    wall_s += outcome.wall_s;
  }
  std::string html = fmt::format(
      "<p>{} rows: {} equal, {} better, {} differ; {:.0f} s.</p>\n<table><tr><th>"
      "published</th><th>what</th><th>made by</th><th>verdict</th></tr>\n",
      outcomes.size(), count[0], count[1], count[2], wall_s);
  for (const Outcome& outcome : outcomes) {
    const Experiment& experiment = *outcome.experiment;
    html += fmt::format(
        "<tr><td><a href=\"#{}\">{}, {}</a></td><td>{}</td><td>{}</td><td class=\"{}\">{}</td></tr>"
        "\n",
        support::escaped_markup(experiment.name), support::escaped_markup(experiment.publication),
        support::escaped_markup(experiment.number), support::escaped_markup(experiment.caption),
        support::escaped_markup(text_of(outcome.means)), to_string(outcome.verdict()),
        support::escaped_markup(outcome.verdict_text()));
  }
  return html + "</table>\n";
}

nlohmann::ordered_json json_of_value(const Value& value) {
  nlohmann::ordered_json json = {{"name", value.name},
                                 {"unit", value.unit},
                                 {"measured", value.measured},
                                 {"expected", nullptr},
                                 {"relation", relation_text(value.relation)},
                                 {"tolerance", value.tolerance},
                                 {"origin", nullptr},
                                 {"verdict", nullptr},
                                 {"by", value.by}};
  if (value.expected) {
    json["expected"] = *value.expected;
    json["origin"] = origin_text(value.origin);
    if (value.relation != Relation::kShown) json["verdict"] = to_string(verdict_of(value));
  }
  return json;
}

nlohmann::ordered_json json_of_outcome(const Outcome& outcome) {
  const Experiment& experiment = *outcome.experiment;
  auto values = nlohmann::ordered_json::array();
  for (const Value& value : outcome.values) values.push_back(json_of_value(value));
  auto tables = nlohmann::ordered_json::array();
  for (const Table& table : outcome.tables) {
    tables.push_back({{"title", table.title}, {"header", table.header}, {"rows", table.rows}});
  }
  auto pictures = nlohmann::ordered_json::array();
  for (const ReportPicture& picture : outcome.pictures) {
    pictures.push_back({{"file", kPictureFolder + picture.file}, {"caption", picture.caption}});
  }
  return {{"name", experiment.name},
          {"publication", experiment.publication},
          {"number", experiment.number},
          {"caption", experiment.caption},
          {"verdict", to_string(outcome.verdict())},
          {"verdict_text", outcome.verdict_text()},
          {"made_by",
           {{"matcher", outcome.means.matcher},
            {"laser_range_m", outcome.means.laser_range_m},
            {"runs", outcome.means.runs}}},
          {"values", values},
          {"tables", tables},
          {"notes", outcome.notes},
          {"pictures", pictures},
          {"wall_s", outcome.wall_s}};
}

}  // namespace

Verdict Outcome::verdict() const {
  return failure.empty() ? verdict_of(values) : Verdict::kDiffers;
}

std::string Outcome::verdict_text() const {
  if (!failure.empty()) return "differs because it failed: " + failure;
  if (verdict() != Verdict::kDiffers) return to_string(verdict());
  const std::string what = differences(values);
  if (what.empty()) return "differs because nothing is compared";
  return "differs because " + what + (experiment->why.empty() ? "" : ". " + experiment->why);
}

Outcome run_experiment(const Experiment& experiment, const std::filesystem::path& folder,
                       SharedRuns& runs) {
  Outcome outcome;
  outcome.experiment = &experiment;
  const double start_s = support::monotonic_s();
  Report report(folder, experiment.name, runs);
  report.made_by(experiment.means);
  try {
    experiment.run(report);
  } catch (const std::exception& error) {
    outcome.failure = error.what();
  }
  outcome.means = report.means();
  outcome.values = report.values();
  outcome.tables = report.tables();
  outcome.notes = report.notes();
  outcome.pictures = report.pictures();
  outcome.wall_s = support::monotonic_s() - start_s;
  return outcome;
}

std::string index_page(const std::vector<Outcome>& outcomes) {
  std::string html = kPageHead + summary_html(outcomes);
  for (const Outcome& outcome : outcomes) html += row_html(outcome);
  return html + "</body></html>\n";
}

std::string index_json(const std::vector<Outcome>& outcomes) {
  auto rows = nlohmann::ordered_json::array();
  for (const Outcome& outcome : outcomes) rows.push_back(json_of_outcome(outcome));
  return nlohmann::ordered_json{{"experiments", rows}}.dump(2) + '\n';
}

}  // namespace topogeo::reproduce
