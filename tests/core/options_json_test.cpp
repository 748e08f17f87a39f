#include "core/options_json.h"

#include <gtest/gtest.h>

namespace parkade {
namespace {

struct InnerOptions {
  double edge = 0.5;
  int count = 3;
  bool is_on = true;
  std::string mode = "fast";
  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("edge", edge);
    visit("count", count);
    visit("is_on", is_on);
    visit("mode", mode);
  }
  void Validate() const { Require(edge > 0, ErrorCode::kUsage, "edge must be positive"); }
};

struct OuterOptions {
  int seed = 1;
  InnerOptions inner;
  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("seed", seed);
    visit("inner", inner);
  }
};

template <typename Function>
std::string UsageError(const Function& function) {
  try {
    function();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kUsage);
    return error.what();
  }
  return "accepted";
}

TEST(OptionsJson, WrittenOptionsAreReadBack) {
  OuterOptions options;
  options.inner.edge = 0.1 + 0.2;
  options.inner.mode = "slow";

  OuterOptions again;
  ReadOptionsFromJson(nlohmann::json::parse(OptionsToJson(options).dump()), again);

  EXPECT_EQ(again.inner.edge, options.inner.edge);
  EXPECT_EQ(again.inner.mode, "slow");
  EXPECT_EQ(again.seed, 1);
}

TEST(OptionsJson, OnlyNamedFieldsChange) {
  OuterOptions options;
  ReadOptionsFromJson({{"inner", {{"count", 7}, {"edge", 2}}}},
                      options);  // a whole number is a number

  EXPECT_EQ(options.inner.count, 7);
  EXPECT_EQ(options.inner.edge, 2);
  EXPECT_TRUE(options.inner.is_on);
}

TEST(OptionsJson, UnknownKeysAndWrongTypesAreRefusedByPath) {
  const auto error = [](const nlohmann::json& json) {
    return UsageError([&] {
      OuterOptions options;
      ReadOptionsFromJson(json, options);
    });
  };
  EXPECT_NE(error({{"inner", {{"egde", 1}}}}).find("'inner.egde'"), std::string::npos);
  EXPECT_NE(error({{"inner", {{"count", 1.7}}}}).find("'inner.count'"), std::string::npos);
  EXPECT_NE(error({{"inner", {{"edge", true}}}}).find("'inner.edge'"), std::string::npos);
  EXPECT_NE(error({{"inner", {{"is_on", 1}}}}).find("'inner.is_on'"), std::string::npos);
  EXPECT_NE(error({{"inner", 3}}).find("'inner'"), std::string::npos);
  EXPECT_NE(error({{"seed", "1"}}).find("'seed'"), std::string::npos);
  EXPECT_NE(error({{"inner", {{"edge", -1}}}}).find("edge must be positive"), std::string::npos);
}

TEST(OptionsJson, OneOptionIsSetFromTheCommandLine) {
  OuterOptions options;
  SetOption("inner.edge=0.25", options);
  SetOption("inner.mode=exact", options);
  SetOption("inner.is_on=false", options);
  SetOption("seed=9", options);

  EXPECT_EQ(options.inner.edge, 0.25);
  EXPECT_EQ(options.inner.mode, "exact");
  EXPECT_FALSE(options.inner.is_on);
  EXPECT_EQ(options.seed, 9);
  for (const char* wrong : {"inner.edge", "=3", "nothing=1", "inner.nothing=1", "inner=1"})
    EXPECT_NE(UsageError([&] { SetOption(wrong, options); }), "accepted") << wrong;
}

/// Valid together only.
struct RangeOptions {
  int begin = 0, end = 0;

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("begin", begin);
    visit("end", end);
  }
  void Validate() const {
    Require(begin <= end, ErrorCode::kUsage, "the end must not lie before the begin");
  }
};

TEST(OptionsJson, OptionsThatAreValidTogetherOnlyAreSetTogether) {
  RangeOptions options;
  SetOptions({"begin=3", "end=5"}, options);

  EXPECT_EQ(options.begin, 3);
  EXPECT_EQ(options.end, 5);
  EXPECT_NE(UsageError([&] { SetOption("end=2", options); }), "accepted");
}

}  // namespace
}  // namespace parkade
