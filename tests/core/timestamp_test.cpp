#include "core/timestamp.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/error.h"

namespace parkade {
namespace {

TEST(Timestamp, DecimalTextKeepsEveryNanosecond) {
  for (const std::int64_t ns :
       {std::int64_t{1403715285262142976}, std::int64_t{0}, std::int64_t{1}, std::int64_t{-1},
        std::int64_t{-1'500'000'000}, std::int64_t{999'999'999}}) {
    EXPECT_EQ(ParseSeconds(ToDecimalSeconds({ns})).ns, ns);
  }
  EXPECT_EQ(ToDecimalSeconds({1403715285262142976}), "1403715285.262142976");
  EXPECT_EQ(ToDecimalSeconds({-1'500'000'000}), "-1.500000000");
  EXPECT_EQ(ToDecimalSeconds({std::numeric_limits<std::int64_t>::min()}), "-9223372036.854775808");
}

TEST(Timestamp, AnyNumberOfDigitsIsReadAndBeyondNineAreCut) {
  EXPECT_EQ(ParseSeconds("12").ns, 12'000'000'000);
  EXPECT_EQ(ParseSeconds("12.5").ns, 12'500'000'000);
  EXPECT_EQ(ParseSeconds("0.1234567899").ns, 123'456'789);
  EXPECT_EQ(ParseSeconds("1.403715285e+09").ns, 1'403'715'285'000'000'000);
}

TEST(Timestamp, WhatIsNotATimeIsRefused) {
  for (const char* text :
       {"", ".", "-", "abc", "1.2.3", "1 ", " 1", "1e", "nan", "inf", "99999999999", "9223372037"})
    EXPECT_THROW(ParseSeconds(text), Error) << "'" << text << "'";
}

TEST(Timestamp, DifferencesAreExactWhereDoublesOfEpochTimesAreNot) {
  const Timestamp time{1403715285262142976};
  EXPECT_EQ(Timestamp{time.ns + 1} - time, 1e-9);
  EXPECT_EQ((time + 0.25).ns, time.ns + 250'000'000);
  EXPECT_EQ((time - 0.25).ns, time.ns - 250'000'000);
}

TEST(TimeSpan, GrowsFromEmpty) {
  TimeSpan span;
  EXPECT_TRUE(span.IsEmpty());
  EXPECT_FALSE(span.Contains({0}));
  EXPECT_EQ(span.Seconds(), 0);

  span.Include({5'000'000'000});
  span.Include({2'000'000'000});

  EXPECT_EQ(span.Seconds(), 3);
  EXPECT_TRUE(span.Contains({2'000'000'000}));
  EXPECT_FALSE(span.Contains({1'999'999'999}));
}

}  // namespace
}  // namespace parkade
