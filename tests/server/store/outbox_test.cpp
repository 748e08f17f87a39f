#include "server/store/tables/outbox.h"

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "server/store/review/review.h"
#include "server/store/tables/names.h"
#include "server/store/tables/webhook_table.h"
#include "tests/server/store/review/published_site.h"

namespace parkade {
namespace {

class Outbox : public PublishedSite {
 protected:
  Webhook Hook(const std::vector<std::string>& events,
               const std::optional<std::string>& site = std::nullopt) {
    Webhook webhook;
    webhook.id = NewId();
    webhook.url = "http://example.org";
    webhook.events = events;
    webhook.site = site;
    webhook.created_at = NowUtc();
    store_.database.Write([&](Connection& connection) { InsertWebhook(connection, webhook); });
    return webhook;
  }
  std::vector<Delivery> DeliveriesOf(const Webhook& webhook, int limit = 5000) {
    return store_.database.Read([&](Connection& connection) {
      return ListDeliveries(connection, webhook.id, {.limit = limit});
    });
  }
  std::vector<Delivery> Due(const std::string& now = UtcIn(std::chrono::seconds(1))) {
    return store_.database.Read(
        [&](Connection& connection) { return DueDeliveries(connection, now); });
  }
  void Update(Delivery delivery) {
    store_.database.Write([&](Connection& connection) { UpdateDelivery(connection, delivery); });
  }
  void NoteTests(const Webhook& webhook, int count) {
    store_.database.Write([&](Connection& connection) {
      for (int i = 0; i < count; ++i) NoteTest(connection, webhook.id);
    });
  }
};

TEST_F(Outbox, TellsOfAPublishedVersionAndItsJob) {
  const Webhook both = Hook({"job", "published"}), published = Hook({"published"}),
                elsewhere = Hook({"job", "published"}, "street");
  PublishAgain();

  ASSERT_EQ(DeliveriesOf(both).size(), 2u);
  EXPECT_TRUE(DeliveriesOf(elsewhere).empty());
  ASSERT_EQ(DeliveriesOf(published).size(), 1u);
  const auto body = nlohmann::json::parse(DeliveriesOf(published)[0].body);
  EXPECT_EQ(body.at("event"), "published");
  EXPECT_EQ(body.at("site"), "lot");
  EXPECT_EQ(body.at("version"), 2);
  const auto job = nlohmann::json::parse(DeliveriesOf(both)[1].body).at("job");
  EXPECT_EQ(job.at("state"), "done");
  EXPECT_EQ(job.at("map_version"), 2);
}

TEST_F(Outbox, TellsOfEveryEndOfAJobOnce) {
  const Webhook webhook = Hook({"job"}, "lot");
  const auto last = [&] { return nlohmann::json::parse(DeliveriesOf(webhook)[0].body).at("job"); };

  QueueMap(store_, "lot", {}, true);
  const Job failed = *ClaimJob(store_);
  FailJob(store_, failed, "invalid_input", "the log has no \xff IMU");
  EXPECT_EQ(last().at("state"), "failed");
  EXPECT_EQ(last().at("error_code"), "invalid_input");
  FailJob(store_, failed, "internal", "again");
  EXPECT_EQ(DeliveriesOf(webhook).size(), 1u) << "it had ended";

  const Job waiting = QueueMap(store_, "lot", {}, true);
  CancelWaitingJob(store_, waiting.id);
  EXPECT_EQ(last().at("state"), "cancelled");
  QueueMap(store_, "lot", {}, true);
  const Job running = *ClaimJob(store_);
  RetryCrashedJob(store_, running, "crashed", "signal 11", {});
  EXPECT_EQ(DeliveriesOf(webhook).size(), 2u) << "it goes on";
  FinishCancelledJob(store_, *ClaimJob(store_));
  EXPECT_EQ(DeliveriesOf(webhook).size(), 3u);
}

TEST_F(Outbox, TellsOfDecisionsButNotOfRemarks) {
  const Webhook webhook = Hook({"reviewed"});
  ReviewVersion(store_, "lot", 1, {"comment", "hm", {}}, "ann");
  EXPECT_TRUE(DeliveriesOf(webhook).empty());
  ReviewVersion(store_, "lot", 1, {"submit", "", {}}, "ann");

  const auto body = nlohmann::json::parse(DeliveriesOf(webhook).at(0).body);
  EXPECT_EQ(body.at("action"), "submit");
  EXPECT_EQ(body.at("to"), "in_review");
  EXPECT_EQ(body.at("author"), "ann");
}

TEST_F(Outbox, GoesWithItsTransaction) {
  const Webhook webhook = Hook({"published"});
  EXPECT_THROW(store_.database.Write([&](Connection& connection) {
    NotePublished(connection, map_);
    throw Error(ErrorCode::kConflict, "no");
  }),
               Error);
  EXPECT_TRUE(DeliveriesOf(webhook).empty());
}

TEST_F(Outbox, GivesOutTheOldestOfEachWebhook) {
  const Webhook a = Hook({"published"}), b = Hook({"published"});
  NoteTests(a, 2);
  NoteTests(b, 2);
  std::vector<Delivery> due = Due();
  ASSERT_EQ(due.size(), 2u);
  EXPECT_EQ(due[0].webhook, a.id);
  EXPECT_EQ(due[0].id, DeliveriesOf(a)[1].id);

  due[0].due_at = UtcIn(std::chrono::hours(1));
  Update(due[0]);
  EXPECT_EQ(Due()[0].id, DeliveriesOf(a)[0].id) << "one that waits holds up no later one";
  EXPECT_TRUE(Due("2000-01-01T00:00:00.000Z").empty());
}

TEST_F(Outbox, IsBounded) {
  const Webhook webhook = Hook({"published"});
  NoteTests(webhook, 3);
  const std::string oldest = DeliveriesOf(webhook).back().id;
  NoteTests(webhook, kMaxWaiting);
  EXPECT_EQ(DeliveriesOf(webhook).back().id, oldest) << "kept in the log";
  EXPECT_EQ(DeliveriesOf(webhook).back().state, DeliveryState::kFailed);
  EXPECT_EQ(store_.database.Read([](Connection& connection) {
    return CountDeliveries(connection, DeliveryState::kWaiting);
  }),
            kMaxWaiting);

  for (Delivery& delivery : DeliveriesOf(webhook)) {
    delivery.state = DeliveryState::kDelivered;
    Update(delivery);
  }
  EXPECT_EQ(DeliveriesOf(webhook).size(), static_cast<size_t>(kMaxDelivered));
}

TEST_F(Outbox, GoesWithItsWebhook) {
  const Webhook webhook = Hook({"published"});
  NoteTests(webhook, 3);
  const Delivery under_way = DeliveriesOf(webhook)[0];
  store_.database.Write([&](Connection& connection) { DeleteWebhook(connection, webhook.id); });

  EXPECT_TRUE(Due().empty());
  Update(under_way);
  EXPECT_TRUE(DeliveriesOf(webhook).empty());
}

}  // namespace
}  // namespace parkade
