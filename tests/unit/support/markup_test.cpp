#include "topogeo/support/markup.hpp"

#include <gtest/gtest.h>

namespace topogeo::support {
namespace {

TEST(Markup, WritesWhatHasAMeaningAsEntities) {
  EXPECT_EQ(escaped_markup("<a href=\"x\">1 & 2</a>"),
            "&lt;a href=&quot;x&quot;&gt;1 &amp; 2&lt;/a&gt;");
  EXPECT_EQ(escaped_markup("room A, 3 m"), "room A, 3 m");
  EXPECT_EQ(escaped_markup(""), "");
}

}  // namespace
}  // namespace topogeo::support
