#include "server/store/review/site_settings.h"

#include "core/error.h"
#include "server/store/rig_store.h"
#include "server/store/tables/site_table.h"
#include "tests/server/store/review/published_site.h"

namespace parkade {
namespace {

class SiteSettings : public PublishedSite {
 protected:
  SiteSettings() {
    StoreRig(store_, "car",
             {{"camchain-imucam.yaml", "a"}, {"imu0.yaml", "b"}, {"vehicle.yaml", "c"}}, nullptr);
  }
  ErrorCode CodeOf(const SiteChange& change, const std::string& name = "lot") {
    return ErrorOf([&] { ChangeSite(store_, name, change); }).code();
  }
  Site Now(const std::string& name = "lot") {
    return store_.database.Read([&](Connection& connection) { return FindSite(connection, name); });
  }
};

TEST_F(SiteSettings, ChangeWhatIsNamedAndNothingElse) {
  EXPECT_FALSE(Now().log_days.has_value()) << "for ever, unless someone says otherwise";
  ChangeSite(store_, "lot",
             {.title = "Level 2",
              .note = "two\nlines",
              .log_days = {{90}},
              .map_days = {{365}},
              .default_rig = {{"car"}}});
  ChangeSite(store_, "lot", {.log_days = {std::optional<std::int64_t>()}});

  EXPECT_EQ(Now().title, "Level 2");
  EXPECT_EQ(Now().note, "two\nlines");
  EXPECT_FALSE(Now().log_days.has_value());
  EXPECT_EQ(Now().map_days, 365);
  EXPECT_EQ(Now().default_rig, "car");
}

TEST_F(SiteSettings, MakeASiteThatIsNotThere) {
  EXPECT_TRUE(ChangeSite(store_, "new", {.default_rig = {{"car"}}}).is_new);
  EXPECT_FALSE(ChangeSite(store_, "new", {.title = "New"}).is_new);
  EXPECT_EQ(Now("new").title, "New");
}

TEST_F(SiteSettings, TakeNothingThatMakesNoSense) {
  EXPECT_EQ(CodeOf({.title = "two\nlines"}), ErrorCode::kInvalidInput);
  EXPECT_EQ(CodeOf({.title = std::string(201, 't')}), ErrorCode::kInvalidInput);
  EXPECT_EQ(CodeOf({.note = std::string(4001, 't')}), ErrorCode::kInvalidInput);
  EXPECT_EQ(CodeOf({.log_days = {{0}}}), ErrorCode::kInvalidInput);
  EXPECT_EQ(CodeOf({.log_days = {{-1}}}), ErrorCode::kInvalidInput);
  EXPECT_EQ(CodeOf({.map_days = {{36'501}}}), ErrorCode::kInvalidInput);
  EXPECT_EQ(CodeOf({.default_rig = {{"truck"}}}), ErrorCode::kInvalidInput);
  EXPECT_EQ(CodeOf({}, "../lot"), ErrorCode::kInvalidInput);
}

TEST_F(SiteSettings, TheDefaultRigIsThatOfUploadsThatNameNone) {
  ChangeSite(store_, "lot", {.default_rig = {{"car"}}});

  EXPECT_EQ(Receive(store_, "b", {"b.bag", "lot", std::nullopt}).drive.rig, "car");
  EXPECT_EQ(Receive(store_, "c", {"c.bag", "lot", "truck"}).drive.rig, "truck");
  EXPECT_FALSE(Receive(store_, "d", {"d.bag", "street", std::nullopt}).drive.rig.has_value());
}

}  // namespace
}  // namespace parkade
