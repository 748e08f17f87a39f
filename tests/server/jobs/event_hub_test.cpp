#include "server/jobs/event_hub.h"

#include <gtest/gtest.h>

#include <thread>

namespace parkade {
namespace {

using std::chrono::milliseconds;

TEST(EventHub, GivesWhatCameAfterTheLastSeen) {
  EventHub hub;
  const std::int64_t start = hub.last_id();
  hub.Publish("job", "a");
  hub.Publish("job", "b");
  hub.Publish("map", "lot/1");

  const EventHub::News all = hub.WaitFor(start, milliseconds(0));
  ASSERT_EQ(all.events.size(), 3u);
  EXPECT_FALSE(all.has_gap);
  EXPECT_EQ(all.events[2].subject, "lot/1");
  EXPECT_EQ(hub.WaitFor(all.events[1].id, milliseconds(0)).events.size(), 1u);
  EXPECT_TRUE(hub.WaitFor(hub.last_id(), milliseconds(0)).events.empty());
}

TEST(EventHub, WakesAWaitingListener) {
  EventHub hub;
  const std::int64_t start = hub.last_id();
  std::thread publisher([&] {
    std::this_thread::sleep_for(milliseconds(50));
    hub.Publish("job", "a");
  });
  const auto began = std::chrono::steady_clock::now();

  const EventHub::News news = hub.WaitFor(start, milliseconds(60'000));

  publisher.join();
  EXPECT_EQ(news.events.size(), 1u);
  EXPECT_LT(std::chrono::steady_clock::now() - began, milliseconds(5'000));
}

TEST(EventHub, SaysWhenTooMuchWasMissed) {
  EventHub hub;
  const std::int64_t start = hub.last_id();
  for (int i = 0; i < 5000; ++i) hub.Publish("job", std::to_string(i));

  EXPECT_TRUE(hub.WaitFor(start, milliseconds(0)).has_gap);
  EXPECT_TRUE(hub.WaitFor(0, milliseconds(0)).has_gap) << "an id of an earlier process";
  EXPECT_TRUE(hub.WaitFor(hub.last_id() + 1000, milliseconds(0)).has_gap);
  EXPECT_FALSE(hub.WaitFor(hub.last_id() - 10, milliseconds(0)).has_gap);
}

TEST(EventHub, LetsNobodyWaitOnceClosed) {
  EventHub hub;
  std::thread closer([&] {
    std::this_thread::sleep_for(milliseconds(50));
    hub.Close();
  });
  const auto began = std::chrono::steady_clock::now();
  hub.WaitFor(hub.last_id(), milliseconds(60'000));
  closer.join();
  EXPECT_LT(std::chrono::steady_clock::now() - began, milliseconds(5'000));
}

}  // namespace
}  // namespace parkade
