// Messages are one line, and a terminal does nothing but show them.
#include "harness/failure.h"

#include <gtest/gtest.h>

namespace pt {
namespace {

TEST(OneLineTest, KeepsTextAndEscapesWhatIsNone) {
    EXPECT_EQ(one_line("plain text, ümläut, 日本, 🙂"), "plain text, ümläut, 日本, 🙂");
    EXPECT_EQ(one_line("a\nb\tc\x1b[31m\x7f"), "a\\x0ab\\x09c\\x1b[31m\\x7f");
    EXPECT_EQ(one_line("\xc2\x9b"
                       "31m"),
              "\\xc2\\x9b31m");  // C1's CSI, which terminals obey
    EXPECT_EQ(one_line("\xff\xfe"), "\\xff\\xfe");
    EXPECT_EQ(one_line("\xc0\xaf"), "\\xc0\\xaf");                    // overlong
    EXPECT_EQ(one_line("\xed\xa0\x80"), "\\xed\\xa0\\x80");           // a surrogate
    EXPECT_EQ(one_line("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");  // beyond U+10FFFF
    EXPECT_EQ(one_line("\xe6\x97"), "\\xe6\\x97");                    // cut off
    EXPECT_EQ(one_line(std::string("\0", 1)), "\\x00");
}

TEST(OneLineTest, ErrorsAreEscaped) {
    EXPECT_STREQ(InputError("a\x1b", "b", "c", "d").what(), "a\\x1b: b: found c, allowed: d");
    EXPECT_STREQ(MachineError("a\x1b").what(), "a\\x1b");
}

}  // namespace
}  // namespace pt
