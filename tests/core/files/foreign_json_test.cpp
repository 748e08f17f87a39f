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
       {std::string(), std::string("{"), std::string("{}}"), Nested(66), Nested(500'000),
        std::string(500'000, '['), R"({"a": 1, "b": )" + Nested(70) + "}"})
    EXPECT_TRUE(ParseForeignJson(text).is_discarded()) << text.substr(0, 20);
}

}  // namespace
}  // namespace parkade
