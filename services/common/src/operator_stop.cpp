#include "topogeo/service/operator_stop.hpp"

#include <algorithm>
#include <system_error>

#include "topogeo/service/runtime_file.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/log.hpp"
#include "topogeo/support/random.hpp"

namespace topogeo::service {
namespace {

constexpr std::uint64_t kOperatorStopFormat = 0x315453504F475054;  // "TPGOPST1": layout of Record

bool has_bytes(const std::filesystem::path& path) {
  std::error_code error;
  const std::uintmax_t size_bytes = std::filesystem::file_size(path, error);
  return !error && size_bytes > 0;
}

/// Time since the last change of the file.
std::optional<std::chrono::seconds> age_of(const std::filesystem::path& path) {
  std::error_code error;
  const auto written = std::filesystem::last_write_time(path, error);
  if (error) return std::nullopt;
  const auto age = std::filesystem::file_time_type::clock::now() - written;
  return std::max(std::chrono::seconds(0), std::chrono::duration_cast<std::chrono::seconds>(age));
}

}  // namespace

std::uint64_t OperatorStop::new_number() {
  return 1 + support::unrepeatable_u64() / 2;
}

std::filesystem::path OperatorStop::place_of(const Setup& setup) {
  return own_runtime_file(setup, ".stop", "a restart forgets an operator's stop");
}

OperatorStop::OperatorStop(const std::filesystem::path& file)
    : path_(file), file_(file, kOperatorStopFormat) {
  if (const std::optional<Record> record = file_.load()) {
    record_ = *record;
    if (holds()) age_at_start_ = age_of(file);
  } else {
    if (has_bytes(file)) {
      spdlog::warn("{}: damaged; the robot is stopped until a release", file.string());
      record_ = {new_number(), 0, 1};
    }
    // Takes the room in the file now: a later stop overwrites it, on a full disk, too.
    store();
  }
  if (!holds()) return;
  spdlog::warn("{}: an operator's stop of before this start holds ({})", file.string(),
               age_in_words(age_at_start_));
}

void OperatorStop::hold(std::uint64_t number) {
  keep({number, record_.released, 1});
  halted_by_.reset();
}

void OperatorStop::release() {
  if (!holds()) return;
  keep({0, record_.number != 0 ? record_.number : record_.released, 0});
  halted_by_.reset();
}

void OperatorStop::hand_over() {
  if (!holds()) return;
  keep({0, record_.released, 0});
  halted_by_.reset();
}

bool OperatorStop::take(const msg::BaseCommand& command, const messaging::Handle& writer) {
  const std::uint64_t number = command.stop_count();
  if (command.kind() == msg::kBaseHalt) {
    if (number != 0 && number == record_.released) return false;
    const bool begins = !holds();
    hold(number);
    halted_by_ = writer;
    return begins;
  }
  if (command.kind() != msg::kBaseReset) return false;
  const bool of_base = number != 0 && number == base_count_;
  // A writer knows its own stops, because they arrive before its release.
  if (holds() && (number == record_.number || of_base || halted_by_ == writer)) {
    release();
    return true;
  }
  // The stop of another writer may arrive after its release.
  if (number != 0) keep({record_.number, number, record_.held});
  return false;
}

void OperatorStop::keep(const Record& record) {
  if (stored_ && record == record_) return;
  record_ = record;
  store();
}

void OperatorStop::store() {
  stored_ = file_.store(record_);
  if (stored_) return;
  spdlog::error("{}: cannot be written; after a restart the robot is stopped until a release",
                path_.string());
}

std::string age_in_words(const std::optional<std::chrono::seconds>& age) {
  constexpr std::chrono::hours kDay{24};
  if (!age) return {};
  if (*age < std::chrono::minutes(2)) return fmt::format("{} s ago", age->count());
  if (*age < std::chrono::hours(2)) {
    return fmt::format("{} min ago", std::chrono::floor<std::chrono::minutes>(*age).count());
  }
  if (*age < 2 * kDay) {
    return fmt::format("{} h ago", std::chrono::floor<std::chrono::hours>(*age).count());
  }
  return fmt::format("{} days ago", *age / kDay);
}

}  // namespace topogeo::service
