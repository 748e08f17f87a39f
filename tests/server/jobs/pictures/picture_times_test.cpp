#include "server/jobs/pictures/picture_times.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace parkade {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

TEST(NearestTime, IsTheNextOneOnEitherSide) {
  const std::vector<Timestamp> times = {{10 * kSecond}, {11 * kSecond}, {20 * kSecond}};
  struct Case {
    double asked, expected;  // 0: none
  };
  for (const Case& c :
       {Case{10, 10}, Case{10.4, 10}, Case{10.6, 11}, Case{10.5, 10}, Case{9.1, 10}, Case{8.9, 0},
        Case{12, 11}, Case{15, 0}, Case{19.2, 20}, Case{20.9, 20}, Case{21.1, 0}}) {
    const auto found = NearestTime(times, TimestampFromSeconds(c.asked), 1);
    EXPECT_EQ(found.value_or(Timestamp{0}).ToSeconds(), c.expected) << c.asked;
  }
  EXPECT_FALSE(NearestTime({}, {0}, 1));
}

TEST(PictureTimes, AreThoseOfTheIndex) {
  const PictureTimes times = ParsePictureTimes(
      R"({"version": 1, "cameras": [{"name": "cam0", "times": [1, 2]}, {"name": "cam1", "times": []}]})");

  ASSERT_EQ(times.cameras.size(), 2u);
  EXPECT_EQ(times.cameras[0].times, (std::vector<Timestamp>{{1}, {2}}));
  EXPECT_EQ(times.NumberOf("cam1"), 1u);
  EXPECT_THROW(times.NumberOf("cam2"), Error);
}

TEST(PictureTimes, RefusesWhatIsNoIndex) {
  for (const char* text : {"", "{", "[]", R"({"cameras": 1})", R"({"cameras": [{"name": "cam0"}]})",
                           R"({"cameras": [{"name": "cam0", "times": ["1"]}]})",
                           R"({"cameras": [{"name": "cam0", "times": [2, 1]}]})"})
    EXPECT_THROW(ParsePictureTimes(text), Error) << text;
}

}  // namespace
}  // namespace parkade
