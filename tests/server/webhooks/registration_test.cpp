#include "server/webhooks/registration.h"

#include "core/error.h"
#include "server/webhooks/signature.h"
#include "tests/server/store/temporary_store.h"

namespace parkade {
namespace {

bool IsTaken(const std::string& url, bool allow_private = false) {
  try {
    CheckWebhookUrl(url, allow_private);
    return true;
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidInput) << url;
    return false;
  }
}

TEST(WebhookUrl, IsAnAddressOfTheWeb) {
  for (const char* url : {"https://example.org/hook", "http://example.org:8080/a?b=c",
                          "https://8.8.8.8/", "https://[2606:4700::1111]/x"})
    EXPECT_TRUE(IsTaken(url)) << url;
  for (const std::string& url :
       {std::string(""), std::string("example.org"), std::string("ftp://example.org/"),
        std::string("file:///etc/passwd"), std::string("gopher://example.org/"),
        std::string("javascript:alert(1)"), std::string("https://"),
        std::string("https://user@example.org/"), std::string("https://user:word@example.org/"),
        std::string("https://example.org/#part"), std::string("https://exa mple.org/"),
        std::string("https://example.org/\r\nX-Other: 1"), std::string("https://example.org:99999"),
        "https://example.org/" + std::string(2000, 'x')})
    EXPECT_FALSE(IsTaken(url, /*allow_private=*/true)) << url;
}

TEST(WebhookUrl, IsNotAPrivateNumber) {
  for (const char* url :
       {"http://127.0.0.1/", "http://2130706433/", "http://0x7f.1/", "http://0177.0.0.1/",
        "http://127.1/", "http://10.0.0.1:80/", "http://169.254.169.254/latest/meta-data",
        "http://[::1]/", "http://[::ffff:127.0.0.1]/", "http://0/"}) {
    EXPECT_FALSE(IsTaken(url)) << url;
    EXPECT_TRUE(IsTaken(url, /*allow_private=*/true)) << url;
  }
}

class Registration : public StoreTest {
 protected:
  Webhook Add(const std::vector<std::string>& events,
              const std::optional<std::string>& site = std::nullopt) {
    return AddWebhook(store_, {"https://example.org/hook", events, site}, false, "ann");
  }
};

TEST_F(Registration, GivesEachWebhookASecretOfItsOwn) {
  const Webhook one = Add({"job"}), other = Add({"job", "published", "reviewed"});
  EXPECT_EQ(one.secret.size(), 64u);
  EXPECT_NE(one.secret, other.secret);
  const Webhook found = store_.database.Read(
      [&](Connection& connection) { return FindWebhook(connection, other.id); });
  EXPECT_EQ(found.events, other.events);
  EXPECT_EQ(found.author, "ann");
  RemoveWebhook(store_, other.id);
  EXPECT_THROW(RemoveWebhook(store_, other.id), Error);
}

TEST_F(Registration, KnowsItsEventsAndSites) {
  for (const std::vector<std::string>& events :
       std::vector<std::vector<std::string>>{{}, {"test"}, {"job", "everything"}, {"job", "job"}})
    EXPECT_THROW(Add(events), Error);
  EXPECT_THROW(Add({"job"}, "none"), Error);
  Receive(store_, "a log", {"a.bag", "lot", std::nullopt});
  EXPECT_EQ(Add({"job"}, "lot").site, "lot");
}

TEST_F(Registration, IsBounded) {
  for (int i = 0; i < 100; ++i) Add({"job"});
  EXPECT_THROW(Add({"job"}), Error);
}

// As Python's hmac has it.
TEST(Signature, IsHmacOverTimestampAndBody) {
  EXPECT_EQ(SignatureOf("key", "1700000000", "{}"),
            "9d713ed406bb7076d4123f0dc2c39d2df5c654ed4b0cd56b52c8b4c940bd63ae");
  EXPECT_NE(SignatureOf("key", "1700000000", "{}"), SignatureOf("key", "1700000001", "{}"));
  EXPECT_NE(SignatureOf("key", "1700000000", "{}"), SignatureOf("kez", "1700000000", "{}"));
}

}  // namespace
}  // namespace parkade
