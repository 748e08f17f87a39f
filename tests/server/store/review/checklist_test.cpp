#include "server/store/review/checklist.h"

#include "core/error.h"
#include "server/store/review/site_settings.h"
#include "tests/server/store/review/published_site.h"

namespace parkade {
namespace {

class ChecklistTest : public PublishedSite {
 protected:
  Checklist Now(std::int64_t version = 1) { return ChecklistOf(store_, "lot", version); }
  void SetItems(const std::optional<std::vector<ChecklistItem>>& items) {
    ChangeSite(store_, "lot", {.review_checklist = items});
  }
  ErrorCode CodeOf(const std::vector<ChecklistItem>& items) {
    return ErrorOf([&] { SetItems(items); }).code();
  }
};

TEST_F(ChecklistTest, IsTheUsualOneUntilTheSiteHasItsOwn) {
  EXPECT_TRUE(Now().is_usual);
  ASSERT_EQ(Now().entries.size(), UsualChecklist().size());
  EXPECT_EQ(Now().entries[0].item, UsualChecklist()[0]);

  SetItems({{{"ramp", "Ramps driven both ways"}}});
  EXPECT_FALSE(Now().is_usual);
  ASSERT_EQ(Now().entries.size(), 1u);
  EXPECT_EQ(Now().entries[0].item.text, "Ramps driven both ways");

  SetItems(std::vector<ChecklistItem>());
  EXPECT_TRUE(Now().entries.empty()) << "a site may go without";
  EXPECT_FALSE(Now().is_usual);
  SetItems(std::nullopt);
  EXPECT_TRUE(Now().is_usual);
}

TEST_F(ChecklistTest, TicksAreOfOneVersionAndSayWhoAndWhen) {
  PublishAgain();
  TickItem(store_, "lot", 1, "loops", true, "ann");
  const Checklist ticked = TickItem(store_, "lot", 1, "loops", true, "bob");

  const auto loops_of = [](const Checklist& checklist) {
    for (const ChecklistEntry& entry : checklist.entries)
      if (entry.item.id == "loops") return entry;
    return ChecklistEntry();
  };
  EXPECT_EQ(loops_of(ticked).ticked_by, "ann") << "who was first stays";
  EXPECT_TRUE(loops_of(Now()).ticked_at);
  EXPECT_FALSE(Now().entries[0].ticked_by);
  EXPECT_FALSE(loops_of(Now(2)).ticked_by) << "another version has to be looked at anew";

  TickItem(store_, "lot", 1, "loops", false, "bob");
  EXPECT_FALSE(loops_of(Now()).ticked_by);
}

TEST_F(ChecklistTest, AnItemKeepsItsTickWithItsId) {
  SetItems({{{"ramp", "Ramps"}, {"bay", "Bays"}}});
  TickItem(store_, "lot", 1, "ramp", true, "ann");
  SetItems({{{"bay", "Bays"}, {"ramp", "Ramps, both ways"}}});
  EXPECT_EQ(Now().entries[1].ticked_by, "ann");

  SetItems({{{"bay", "Bays"}}});
  EXPECT_EQ(Now().entries.size(), 1u) << "a tick of an item that is gone shows nowhere";
}

TEST_F(ChecklistTest, OnlyWhatThereIsCanBeTicked) {
  EXPECT_EQ(ErrorOf([&] { TickItem(store_, "lot", 1, "ramp", true, "ann"); }).code(),
            ErrorCode::kNotFound);
  EXPECT_EQ(ErrorOf([&] { TickItem(store_, "lot", 9, "loops", true, "ann"); }).code(),
            ErrorCode::kNotFound);
  EXPECT_EQ(ErrorOf([&] { ChecklistOf(store_, "elsewhere", 1); }).code(), ErrorCode::kNotFound);
}

TEST_F(ChecklistTest, TakesNoListThatMakesNoSense) {
  EXPECT_EQ(CodeOf({{"a", ""}}), ErrorCode::kInvalidInput);
  EXPECT_EQ(CodeOf({{"a", "two\nlines"}}), ErrorCode::kInvalidInput);
  EXPECT_EQ(CodeOf({{"a", std::string(301, 't')}}), ErrorCode::kInvalidInput);
  EXPECT_EQ(CodeOf({{"", "A"}}), ErrorCode::kInvalidInput);
  EXPECT_EQ(CodeOf({{"../a", "A"}}), ErrorCode::kInvalidInput);
  EXPECT_EQ(CodeOf({{"a", "A"}, {"a", "B"}}), ErrorCode::kInvalidInput);
  std::vector<ChecklistItem> many;
  for (int i = 0; i < 51; ++i) many.push_back({"item-" + std::to_string(i), "Look"});
  EXPECT_EQ(CodeOf(many), ErrorCode::kInvalidInput);
  EXPECT_TRUE(Now().is_usual);
}

}  // namespace
}  // namespace parkade
