#include "graphdrl/base/error.h"

#include <gtest/gtest.h>

namespace graphdrl {
namespace {

TEST(Error, SaysWhatExpectedGotAndWhere) {
  const Error error({.what = "bad value", .expected = "1 or 2", .got = "3", .where = "file.txt:4"});
  EXPECT_STREQ(error.what(), "file.txt:4: bad value: expected 1 or 2, got 3");
  EXPECT_STREQ(Error({.what = "bad", .got = "3"}).what(), "bad: got 3");
}

TEST(Error, IsOneLineWhateverItQuotes) {
  const Error error({.what = "bad name", .got = "a\nb\x1b[31m", .where = "dir\n/x"});
  EXPECT_STREQ(error.what(), "dir\\x0a/x: bad name: got a\\x0ab\\x1b[31m");
}

TEST(InQuotes, CutsLongTexts) {
  EXPECT_EQ(in_quotes("abcdef", 3), "'abc…'");
}

}  // namespace
}  // namespace graphdrl
