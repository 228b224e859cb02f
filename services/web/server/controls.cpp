#include "server/controls.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "server/json_values.hpp"

namespace topogeo::web {
namespace {

constexpr std::size_t kMostPages = 256;  // remembered without a connection

std::string shortened(const std::string& name) {
  if (name.empty()) return "an operator";
  std::size_t end = std::min(name.size(), Controls::kLongestName);
  // Not within a character of UTF-8.
  while (end < name.size() && end > 0 && (static_cast<unsigned char>(name[end]) & 0xC0U) == 0x80U) {
    --end;
  }
  return name.substr(0, end);
}

}  // namespace

Controls::Controls(std::function<void(std::string json)> show) : show_(std::move(show)) {
  const std::scoped_lock lock(mutex_);
  this->show();
}

std::uint32_t Controls::enter(std::uint64_t viewer, const std::string& id,
                              const std::string& name) {
  if (id.empty()) return 0;
  const std::scoped_lock lock(mutex_);
  Page& page = pages_[id];
  if (page.number == 0) page.number = ++last_number_;
  page.name = shortened(name);
  page.viewers.insert(viewer);
  page_of_[viewer] = id;
  const std::uint32_t number = page.number;
  forget_old_pages();
  show();
  return number;
}

void Controls::leave(std::uint64_t viewer) {
  const std::scoped_lock lock(mutex_);
  const auto found = page_of_.find(viewer);
  if (found == page_of_.end()) return;
  pages_[found->second].viewers.erase(viewer);
  if (asking_ == found->second) asking_.clear();
  page_of_.erase(found);
  show();
}

void Controls::rename(const std::string& id, const std::string& name) {
  const std::scoped_lock lock(mutex_);
  const auto page = pages_.find(id);
  if (page == pages_.end()) return;
  page->second.name = shortened(name);
  show();
}

void Controls::forget_old_pages() {
  for (auto page = pages_.begin(); pages_.size() > kMostPages && page != pages_.end();) {
    const bool needed = !page->second.viewers.empty() || page->first == holder_;
    page = needed ? std::next(page) : pages_.erase(page);
  }
}

bool Controls::is_free() const {
  const auto page = pages_.find(holder_);
  return page == pages_.end() || page->second.viewers.empty();
}

bool Controls::admit_page(const std::string& id) {
  if (id.empty() || (id == holder_ && pages_.contains(id))) return true;
  if (!is_free()) return false;
  if (!pages_.contains(id)) return true;  // its connection is not there yet
  holder_ = id;
  if (asking_ == id) asking_.clear();
  show();
  return true;
}

bool Controls::admit(const std::string& id) {
  const std::scoped_lock lock(mutex_);
  return admit_page(id);
}

bool Controls::admit(std::uint64_t viewer) {
  const std::scoped_lock lock(mutex_);
  const auto page = page_of_.find(viewer);
  return page == page_of_.end() || admit_page(page->second);
}

std::string Controls::refusal() const {
  return holder() + " has the controls: ask for them, or take over";
}

void Controls::ask(const std::string& id) {
  const std::scoped_lock lock(mutex_);
  if (!pages_.contains(id) || admit_page(id)) return;
  asking_ = id;
  show();
}

void Controls::answer(const std::string& id, bool give) {
  const std::scoped_lock lock(mutex_);
  if (id != holder_ || asking_.empty()) return;
  const std::string asked = std::exchange(asking_, {});
  if (give) holder_ = asked;
  show();
}

void Controls::let_go(const std::string& id) {
  const std::scoped_lock lock(mutex_);
  if (id != holder_) return;
  holder_ = std::exchange(asking_, {});
  show();
}

std::vector<std::uint64_t> Controls::take(const std::string& id) {
  const std::scoped_lock lock(mutex_);
  if (!pages_.contains(id) || id == holder_) return {};
  std::vector<std::uint64_t> viewers;
  if (const auto before = pages_.find(holder_); before != pages_.end()) {
    viewers.assign(before->second.viewers.begin(), before->second.viewers.end());
  }
  holder_ = id;
  if (asking_ == id) asking_.clear();
  show();
  return viewers;
}

void Controls::set_stopped_by(const std::string& name) {
  const std::scoped_lock lock(mutex_);
  if (stopped_by_ == name) return;
  stopped_by_ = name;
  show();
}

std::string Controls::name_of(const std::string& id) const {
  const std::scoped_lock lock(mutex_);
  if (id.empty()) return "a program";
  const auto page = pages_.find(id);
  return page == pages_.end() ? "an operator" : page->second.name;
}

std::string Controls::holder() const {
  const std::scoped_lock lock(mutex_);
  return is_free() ? std::string() : pages_.at(holder_).name;
}

void Controls::show() {
  const auto page_json = [this](const std::string& id) {
    const auto page = pages_.find(id);
    if (page == pages_.end()) return Json();
    return Json{{"page", page->second.number}, {"name", page->second.name}};
  };
  show_(text_of(Json{{"holder", is_free() ? Json() : page_json(holder_)},
                     {"asking", page_json(asking_)},
                     {"stopped_by", stopped_by_}}));
}

}  // namespace topogeo::web
