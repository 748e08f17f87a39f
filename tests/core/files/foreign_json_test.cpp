#include "core/files/foreign_json.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

namespace parkade {
namespace {

std::string Nested(size_t depth) { return std::string(depth, '[') + std::string(depth, ']'); }

TEST(ForeignJson, IsReadAsItIs) {
  EXPECT_EQ(ParseForeignJson(R"({"a": [1, {"b": "c"}]})"),
            nlohmann::json({{"a", {1, {{"b", "c"}}}}}));
  EXPECT_FALSE(ParseForeignJson(Nested(64)).is_discarded());
  EXPECT_TRUE(ParseForeignJson("null").is_null());
}

TEST(ForeignJson, OfAnotherKindOrNestedTooDeeplyIsDiscarded) {
  for (const std::string& text :
       {std::string(), std::string("{"), std::string("{}}"), Nested(65), Nested(500'000),
        std::string(500'000, '['), R"({"a": 1, "b": )" + Nested(70) + "}"})
    EXPECT_TRUE(ParseForeignJson(text).is_discarded()) << text.substr(0, 20);
}

TEST(ForeignJson, BracketsInStringsDoNotCount) {
  const std::string brackets(100, '[');
  EXPECT_EQ(ParseForeignJson('"' + brackets + '"'), brackets);
  EXPECT_EQ(ParseForeignJson(R"(["\"[", "\\", [")" + brackets + R"("]])").size(), 3U);
  EXPECT_TRUE(ParseForeignJson(R"(["\\", )" + Nested(64) + "]").is_discarded());
}

TEST(ForeignJson, ManySiblingsTakeNoLonger) {
  std::string many = "[{}";
  for (int i = 0; i < 500'000; ++i) many += ",{}";
  EXPECT_EQ(ParseForeignJson(many + "]").size(), 500'001U);  // in hours by the parser's callback
}

}  // namespace
}  // namespace parkade
