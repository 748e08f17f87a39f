#include "server/http/access/known_callers.h"

#include <gtest/gtest.h>

namespace parkade {
namespace {

RequestHead With(const std::string& fields) {
  return ParseRequestHead("GET /api/v1/drives HTTP/1.1\r\nHost: localhost\r\n" + fields + "\r\n");
}

TEST(KnownCallers, AreToldByTheirTokenOrSession) {
  KnownCallers known;
  known.Note("secret");
  EXPECT_TRUE(known.Knows(With("Authorization: Bearer secret\r\n")));
  EXPECT_TRUE(known.Knows(With("authorization: bearer secret\r\n")));
  EXPECT_TRUE(known.Knows(With("Cookie: a=b; parkade=secret\r\n")));
  EXPECT_TRUE(
      known.Knows(With("X-Forwarded-Proto: https\r\nCookie: __Host-parkade=secret; c=d\r\n")));
}

TEST(KnownCallers, AreNotThoseWhoShowSomethingElse) {
  KnownCallers known;
  known.Note("secret");
  for (const char* fields :
       {"", "Authorization: Bearer secret2\r\n", "Authorization: Basic secret\r\n",
        "Authorization: secret\r\n", "Authorization: \r\n", "Cookie: other=secret\r\n",
        "Cookie: __Host-parkade=secret\r\n", "Cookie: parkade=\r\n"})
    EXPECT_FALSE(known.Knows(With(fields))) << fields;
}

TEST(KnownCallers, AreForgottenWhereThereAreMany) {
  KnownCallers known(2);
  for (const char* secret : {"a", "b", "b", "c"}) known.Note(secret);
  EXPECT_FALSE(known.Knows(With("Authorization: Bearer a\r\n")));
  EXPECT_TRUE(known.Knows(With("Authorization: Bearer b\r\n")));
  EXPECT_TRUE(known.Knows(With("Authorization: Bearer c\r\n")));
}

}  // namespace
}  // namespace parkade
