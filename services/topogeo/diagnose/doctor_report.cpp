#include "diagnose/doctor_report.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "topogeo/support/format.hpp"
#include "topogeo/support/printable.hpp"

namespace topogeo::cli {
namespace {

/// Columns of severity and check name, including their separators.
constexpr std::size_t kSeverityWidth = 9;
constexpr std::size_t kCheckWidth = 18;

const char* severity_name(Severity severity) {
  switch (severity) {
    case Severity::kGood:
      return "ok";
    case Severity::kHint:
      return "hint";
    case Severity::kProblem:
      return "problem";
  }
  return "unknown";
}

/// `text` broken between words after `head`, with further lines indented to its width.
std::string hanging(std::string head, const std::string& raw_text, std::size_t columns) {
  const std::string text = support::printable(raw_text);
  const std::string indent(head.size(), ' ');
  std::string lines;
  std::string line = std::move(head);
  bool empty = true;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    if (!empty && line.size() + 1 + word.size() > columns) {
      lines += line + "\n";
      line = indent;
      empty = true;
    }
    line += (empty ? "" : " ") + word;
    empty = false;
    begin = end + 1;
  }
  return lines + line + "\n";
}

}  // namespace

std::size_t count(std::span<const Finding> findings, Severity severity) {
  return static_cast<std::size_t>(std::ranges::count(findings, severity, &Finding::severity));
}

std::string findings_text(std::span<const Finding> findings, std::size_t columns) {
  std::string text;
  for (const Finding& finding : findings) {
    text += hanging(fmt::format("{:<{}}{:<{}}", severity_name(finding.severity), kSeverityWidth,
                                finding.check, kCheckWidth),
                    finding.what, columns);
    const auto add = [&](const char* name, const std::string& part) {
      if (part.empty()) return;
      text += hanging(std::string(kSeverityWidth, ' ') + fmt::format("{:<5}", name), part, columns);
    };
    add("why", finding.why);
    add("do", finding.remedy);
  }
  const std::size_t problems = count(findings, Severity::kProblem);
  const std::size_t hints = count(findings, Severity::kHint);
  return text + fmt::format("{} problem{}, {} hint{}\n",
                            problems == 0 ? "no" : std::to_string(problems),
                            problems == 1 ? "" : "s", hints == 0 ? "no" : std::to_string(hints),
                            hints == 1 ? "" : "s");
}

std::string findings_json(std::span<const Finding> findings) {
  nlohmann::ordered_json report = {{"problems", count(findings, Severity::kProblem)},
                                   {"hints", count(findings, Severity::kHint)},
                                   {"findings", nlohmann::ordered_json::array()}};
  for (const Finding& finding : findings) {
    report["findings"].push_back({{"check", finding.check},
                                  {"severity", severity_name(finding.severity)},
                                  {"what", finding.what},
                                  {"why", finding.why},
                                  {"remedy", finding.remedy}});
  }
  // File names may be invalid UTF-8.
  return report.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace topogeo::cli
