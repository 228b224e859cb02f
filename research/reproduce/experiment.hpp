// One row of the reproduction: a figure or table of a publication, and the code for its
// counterpart.
//
// A new experiment needs a function that measures and draws with a Report, and a line in the list
// of its chapter (chapter4.cpp, ...).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "topogeo/render/figure.hpp"

#include "reproduce/measured.hpp"

namespace topogeo::reproduce {

class SharedRuns;

struct ReportPicture {
  std::string file;  ///< name in the folder of all results
  std::string caption;
};

/// Collects an experiment's measurements and writes its pictures.
class Report {
 public:
  /// `folder` exists; pictures are <experiment>.png and <experiment>_<part>.png in it.
  Report(std::filesystem::path folder, std::string experiment, SharedRuns& runs);

  /// Sets the means that make the values of this row.
  void made_by(Means means) { means_ = std::move(means); }

  // The tolerance of a value is that of tolerances.hpp for its name; without an entry there it has
  // to be exact.

  /// For people only.
  void show(std::string name, double measured, std::string unit = "");
  /// A value of other means than those of the row, for people only: it never changes the verdict.
  void beside(std::string name, double measured, std::string unit, std::string by);
  /// Expected to equal the printed value.
  void printed(std::string name, double measured, double expected, std::string unit = "");
  /// Expected to equal the value worked out by hand.
  void worked_out(std::string name, double measured, double expected, std::string unit = "");
  /// The smaller or the larger, the better.
  void at_most(std::string name, double measured, double printed, std::string unit = "");
  void at_least(std::string name, double measured, double printed, std::string unit = "");
  /// A statement of the publication that holds or does not.
  void states(std::string statement, bool holds);

  void add(Table table) { tables_.push_back(std::move(table)); }
  void note(std::string text) { notes_.push_back(std::move(text)); }
  void draw(const render::Figure& figure, const std::string& caption = "",
            const std::string& part = "");
  /// Keeps the bytes of a PNG file drawn elsewhere.
  void keep_picture(const std::string& bytes, const std::string& caption,
                    const std::string& part = "");

  [[nodiscard]] const Means& means() const { return means_; }
  [[nodiscard]] const std::vector<Value>& values() const { return values_; }
  [[nodiscard]] const std::vector<Table>& tables() const { return tables_; }
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }
  [[nodiscard]] const std::vector<ReportPicture>& pictures() const { return pictures_; }
  /// Drives shared by several experiments.
  [[nodiscard]] SharedRuns& runs() { return *runs_; }

 private:
  void compare(std::string name, double measured, double expected, std::string unit,
               Relation relation, Origin origin);

  std::filesystem::path folder_;
  std::string experiment_;
  SharedRuns* runs_;
  Means means_;
  std::vector<Value> values_;
  std::vector<Table> tables_;
  std::vector<std::string> notes_;
  std::vector<ReportPicture> pictures_;
};

struct Experiment {
  std::string name;         ///< "figure-4.8": in file names and on the command line
  std::string publication;  ///< short name of docs/algorithms.md
  std::string number;       ///< "Figure 4.8"
  std::string caption;      ///< contents of the figure, in our words
  void (*run)(Report&) = nullptr;
  std::string why{};    ///< the known reason for differences, if there are any
  bool drives = false;  ///< takes seconds: it simulates whole drives
  Means means{};        ///< unless the run says so itself
};

/// All experiments, in the order of the publications; names are unique.
const std::vector<Experiment>& experiments();

// One function per chapter; those of chapters 4, 7 and 8 are in headers of their own.
std::vector<Experiment> chapter5();
std::vector<Experiment> chapter6();
std::vector<Experiment> macondo();

}  // namespace topogeo::reproduce
