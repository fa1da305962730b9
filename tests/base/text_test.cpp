// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "base/counted.h"
#include "base/csv.h"
#include "base/did_you_mean.h"
#include "base/progress.h"
#include "base/sha256.h"
#include "base/text_checks.h"
#include "tests/base/temporary_folder.h"

namespace pinchlab {
namespace {

using Words = std::vector<std::string>;

TEST(Counted, OneIsNoPlural) {
  EXPECT_EQ(counted(1, "trial"), "1 trial");
  EXPECT_EQ(counted(0, "trial"), "0 trials");
  EXPECT_EQ(counted(2L, "match", "es"), "2 matches");
}

TEST(Csv, QuotesWhatRfc4180Asks) {
  EXPECT_EQ(csv_cell("plain text"), "plain text");
  EXPECT_EQ(csv_cell(""), "");
  EXPECT_EQ(csv_cell("a,b"), "\"a,b\"");
  EXPECT_EQ(csv_cell("\""), "\"\"\"\"");
  EXPECT_EQ(csv_cell("two\nlines"), "\"two\nlines\"");
  EXPECT_EQ(csv_cell("\r"), "\"\r\"");
}

TEST(DidYouMean, TheNearestWordOrNone) {
  const Words keys = {"length_m", "mass_kg", "radius_m", "rail_axis"};
  EXPECT_EQ(nearest_word("lenght_m", keys), "length_m") << "a swap";
  EXPECT_EQ(nearest_word("mass", keys), "mass_kg") << "the unit is missing";
  EXPECT_EQ(nearest_word("radiusm", keys), "radius_m") << "one letter is missing";
  EXPECT_EQ(nearest_word("colour", keys), "");
  EXPECT_EQ(nearest_word("min", Words{"kind", "max"}), "") << "two of three letters";
  EXPECT_EQ(nearest_word("mni", Words{"kind", "min"}), "min");
  EXPECT_EQ(nearest_word("", keys), "");
  EXPECT_EQ(nearest_word("x", Words{"y"}), "") << "all of it would be mistyped";
  EXPECT_EQ(nearest_word("mass_kg", {}), "");
  EXPECT_EQ(nearest_word(std::string(65, 'a'), Words{std::string(64, 'a')}), "");
  EXPECT_EQ(did_you_mean("lenght_m", keys), " (did you mean `length_m`?)");
  EXPECT_EQ(did_you_mean("colour", keys), "");
}

TEST(TextChecks, Names) {
  EXPECT_EQ(why_not_a_name("Åsa 3"), "");
  for (const char* bad : {"", " a", "a ", "a\nb", "\x7f", "\xff", "\xc0\xaf", "\xed\xa0\x80"}) {
    EXPECT_NE(why_not_a_name(bad), "") << bad;
  }
  EXPECT_NE(why_not_a_name(std::string(129, 'a')), "");
  EXPECT_EQ(one_of(Words{"a", "b", "c"}), "`a`, `b` or `c`");
}

TEST(TextChecks, NumbersFillTheTextAndAreFinite) {
  EXPECT_EQ(parse_number("-1.5e3"), -1500.0);
  for (const char* bad : {"", " 1", "1 ", "1,5", "nan", "inf", "0x10", "1e999", "+1"}) {
    EXPECT_EQ(parse_number(bad), std::nullopt) << bad;
  }
  EXPECT_EQ(parse_whole("7", 1, 7), 7);
  for (const char* bad : {"", "8", "0", "7.0", "99999999999999999999", "7x"}) {
    EXPECT_EQ(parse_whole(bad, 1, 7), std::nullopt) << bad;
  }
}

// FIPS 180-4's examples, and a million times "a" (NIST's third).
TEST(Sha256, ExamplesOfTheStandard) {
  EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  const std::string million = "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0";
  Sha256 sha;
  for (int i = 0; i < 1000; ++i) {
    sha.add(std::string(1000, 'a'));
  }
  EXPECT_EQ(sha.hex(), million);
  const pinchlab::test::TemporaryFolder folder;
  EXPECT_EQ(sha256_of_file(folder.write("a", std::string(1'000'000, 'a'))), million);
}

TEST(Progress, Times) {
  EXPECT_EQ(minutes_and_seconds(-1), "0:00");
  EXPECT_EQ(minutes_and_seconds(9.4), "0:09");
  EXPECT_EQ(minutes_and_seconds(725), "12:05");
  EXPECT_EQ(minutes_and_seconds(3723), "1:02:03");
}

}  // namespace
}  // namespace pinchlab
