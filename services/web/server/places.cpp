#include "server/places.hpp"

#include <algorithm>
#include <map>
#include <string_view>

namespace topogeo::web {

bool Places::enter(Guest& guest) {
  leave(guest);
  const bool full = guests_.size() >= most_;
  if (full) {
    Guest& other = dispensable();
    leave(other);
    other.give_way();
  }
  guest.held_ = this;
  guest.place_ = guests_.insert(guests_.end(), &guest);
  return !full;
}

void Places::touch(Guest& guest) {
  if (guest.held_ == nullptr) return;
  std::list<Guest*>& guests = guest.held_->guests_;
  guests.splice(guests.end(), guests, guest.place_);
}

void Places::leave(Guest& guest) {
  if (guest.held_ == nullptr) return;
  guest.held_->guests_.erase(guest.place_);
  guest.held_ = nullptr;
}

Places::Guest& Places::dispensable() const {
  std::map<std::string_view, std::size_t> places;
  for (const Guest* guest : guests_) ++places[guest->address()];
  // The first one listed was silent longest. It gives way if several addresses have the most.
  return **std::ranges::max_element(guests_, {},
                                    [&](const Guest* guest) { return places[guest->address()]; });
}

}  // namespace topogeo::web
