#include "topogeo/support/value_pointer.hpp"

#include <memory>
#include <string>
#include <utility>

#include <gtest/gtest.h>

namespace topogeo::support {
namespace {

struct Word {
  std::string text;
  int number = 0;
};

TEST(ValuePointer, OwnsAValueOfItsOwn) {
  ValuePointer<Word> a(std::in_place, "one", 1);
  ValuePointer<Word> b = a;
  b->text = "two";
  EXPECT_EQ(a->text, "one");
  EXPECT_EQ((*b).text, "two");
  a = b;
  b->number = 3;
  EXPECT_EQ(a->text, "two");
  EXPECT_EQ(a->number, 1);
}

TEST(ValuePointer, AMoveKeepsTheValueInPlace) {
  ValuePointer<Word> a(std::in_place, "one");
  const Word* value = &*a;
  const ValuePointer<Word> b = std::move(a);
  EXPECT_EQ(&*b, value);
}

TEST(ValuePointer, HoldsValuesThatOnlyMove) {
  ValuePointer<std::unique_ptr<int>> a(std::in_place, std::make_unique<int>(5));
  ValuePointer<std::unique_ptr<int>> b = std::move(a);
  EXPECT_EQ(**b, 5);
}

}  // namespace
}  // namespace topogeo::support
