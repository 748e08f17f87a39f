#include "tests/support/api_description.h"

#include <gtest/gtest.h>

namespace parkade {
namespace {

using Json = nlohmann::json;

TEST(MismatchWith, FindsNothingInWhatIsDescribed) {
  const Json pin = {
      {"point", {1, 2.5, 3}}, {"latitude", 48.1}, {"longitude", 11}, {"height", nullptr}};
  EXPECT_EQ(MismatchWith("WantedPin", pin), "");
  EXPECT_EQ(MismatchWith("Upload", {{"id", "1"},
                                    {"filename", "a.bag"},
                                    {"site", nullptr},
                                    {"rig", nullptr},
                                    {"state", "receiving"},
                                    {"error", nullptr},
                                    {"error_code", nullptr},
                                    {"length", 9},
                                    {"offset", 0},
                                    {"drive", nullptr},
                                    {"set", nullptr},
                                    {"created_at", "2026-11-27T08:00:00Z"},
                                    {"expires_at", "2026-11-28T08:00:00.123Z"}}),
            "");
  EXPECT_EQ(MismatchWith("Delivery", Json::object()), " lacks the member \"id\"");
}

TEST(MismatchWith, NamesThePlaceOfWhatIsNot) {
  const Json session = {{"access", "open"}, {"caller", nullptr}, {"csrf", nullptr}};
  EXPECT_EQ(MismatchWith("Session", session), "");
  const auto with = [&](const char* member, const Json& value) {
    Json other = session;
    other[member] = value;
    return MismatchWith("Session", other);
  };
  EXPECT_EQ(with("access", "closed"), "/access is \"closed\", against enum [\"open\",\"token\"]");
  EXPECT_EQ(with("csrf", 7), "/csrf is 7, against type [\"string\",\"null\"]");
  EXPECT_EQ(with("secret", 7), " has the member 'secret', which is not described");
  EXPECT_NE(with("caller", {{"name", "anne"}}), "") << "one of two schemas, and neither fits";

  const Json pin = {{"point", {1, 2}}, {"latitude", 48}, {"longitude", 11}};
  EXPECT_EQ(MismatchWith("WantedPin", pin), "/point has 2 items");
  EXPECT_EQ(MismatchWith("Time", "yesterday"), " is \"yesterday\", against format \"date-time\"");
  EXPECT_NE(MismatchWith("DriveTime", "10.0"), "");
  EXPECT_NE(MismatchWith("Retention", {{"log_days", 0}, {"map_days", nullptr}}), "");
}

TEST(MismatchWith, LooksThroughPartsOfASchema) {
  Json token = {
      {"id", "1"},          {"name", "anne"},        {"role", "viewer"},
      {"sites", {"lot"}},   {"pictures", false},     {"created_at", "2026-11-27T08:00:00Z"},
      {"used_at", nullptr}, {"expires_at", nullptr}, {"revoked_at", nullptr}};
  EXPECT_EQ(MismatchWith("Token", token), "");
  EXPECT_EQ(MismatchWith("MadeToken", token), " lacks the member \"token\"");
  token["token"] = "secret";
  EXPECT_EQ(MismatchWith("MadeToken", token), "");
  EXPECT_EQ(MismatchWith("Token", token), " has the member 'token', which is not described");
}

}  // namespace
}  // namespace parkade
