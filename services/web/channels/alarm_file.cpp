#include "channels/alarm_file.hpp"

#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "topogeo/support/atomic_file.hpp"
#include "topogeo/support/file_content.hpp"

#include "server/bounded_json.hpp"

namespace topogeo::web {
namespace {

constexpr std::string_view kFirstLine = R"({"topogeo":"alarms"})";

std::string line_of(std::uint64_t number, const Alarm* alarm) {
  Json json = {{"number", number}};
  if (alarm != nullptr) {
    json["level"] = alarm->level;
    json["source"] = alarm->source;
    json["text"] = alarm->text;
    json["first_ns"] = alarm->first_ns;
    json["last_ns"] = alarm->last_ns;
    json["count"] = alarm->count;
    json["acknowledged_by"] = alarm->acknowledged_by;
    json["acknowledged_ns"] = alarm->acknowledged_ns;
  }
  return text_of(json) + '\n';
}

/// Applies a line to the alarms. Throws Json::exception if it is damaged.
void read_line(const std::string& line, Alarms& alarms) {
  const Json json = parse_bounded(line);
  const auto number = json.at("number").get<std::uint64_t>();
  if (!json.contains("text")) {
    alarms.erase(number);
    return;
  }
  alarms[number] = {json.at("level").get<std::string>(),
                    json.at("source").get<std::string>(),
                    json.at("text").get<std::string>(),
                    json.at("first_ns").get<std::int64_t>(),
                    json.at("last_ns").get<std::int64_t>(),
                    json.at("count").get<std::uint64_t>(),
                    json.at("acknowledged_by").get<std::string>(),
                    json.at("acknowledged_ns").get<std::int64_t>()};
}

Alarms read_alarms(const std::filesystem::path& file) {
  Alarms alarms;
  if (!std::filesystem::exists(file)) return alarms;
  std::istringstream in(support::file_content(file));
  std::string line;
  if (std::getline(in, line) && line != kFirstLine) {
    throw std::runtime_error("alarms " + file.string() + ": expected a file of alarms, beginning " +
                             std::string(kFirstLine));
  }
  while (std::getline(in, line)) {
    try {
      read_line(line, alarms);
    } catch (const Json::exception&) {
      continue;  // it was being written when the service or the machine ended
    }
  }
  return alarms;
}

}  // namespace

AlarmFile::AlarmFile(std::filesystem::path file, std::size_t most)
    : file_(std::move(file)), most_(most) {}

Alarms AlarmFile::open() {
  if (file_.empty()) return {};
  std::error_code no_folder;  // then the file cannot be written either
  std::filesystem::create_directories(std::filesystem::absolute(file_).parent_path(), no_folder);
  Alarms alarms = read_alarms(file_);
  while (alarms.size() > most_) alarms.erase(alarms.begin());
  replace(alarms);
  return alarms;
}

bool AlarmFile::keep(std::uint64_t number, const Alarms& alarms) {
  if (file_.empty()) return true;
  if (!out_ || lines_ >= kLinesPerAlarm * most_) {
    try {
      replace(alarms);
    } catch (const std::runtime_error&) {
      return false;
    }
    return true;
  }
  const auto found = alarms.find(number);
  // Flushed: the line is the kernel's before the page shows the alarm.
  out_ << line_of(number, found != alarms.end() ? &found->second : nullptr) << std::flush;
  ++lines_;
  return out_.good();
}

void AlarmFile::replace(const Alarms& alarms) {
  std::string content = std::string(kFirstLine) + '\n';
  for (const auto& [number, alarm] : alarms) content += line_of(number, &alarm);
  out_.close();
  support::write_file_atomically(file_, content);
  out_ = std::ofstream(file_, std::ios::app);
  if (!out_) throw std::runtime_error("alarms " + file_.string() + ": cannot be opened");
  lines_ = alarms.size();
}

}  // namespace topogeo::web
