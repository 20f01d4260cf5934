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

TEST(Escaped, LeavesTerminalsNoCodes) {
  EXPECT_EQ(escaped("a\033[31m\n\x7f"), "a\\x1b[31m\\x0a\\x7f");
  EXPECT_EQ(escaped("\xC2\x9B"
                    "31m"),
            "\\x9b31m");  // one code in place of two characters
  EXPECT_EQ(escaped("ü\xC2\xA0 \xC2"), "ü\xC2\xA0 \xC2");
}

}  // namespace
}  // namespace graphdrl
