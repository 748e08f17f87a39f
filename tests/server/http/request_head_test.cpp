#include "server/http/request_head.h"

#include <gtest/gtest.h>

#include "server/http/byte_range.h"
#include "server/http/listen_address.h"

namespace parkade {
namespace {

TEST(RequestHead, IsReadAsItCame) {
  const RequestHead head = ParseRequestHead(
      "PUT /api/v1/drives?filename=a%20b HTTP/1.1\r\nHost: h\r\nContent-LENGTH:\t12 \r\n\r\n");

  EXPECT_EQ(head.method, "PUT");
  EXPECT_EQ(head.Path(), "/api/v1/drives");
  EXPECT_EQ(head.Find("content-length"), "12");
  EXPECT_FALSE(head.Find("range").has_value());
  EXPECT_EQ(CheckRequestHead(head), 12);
}

TEST(RequestHead, ReachesTheLibraryWithALengthAndWithoutRangeOrCompression) {
  const RequestHead head = ParseRequestHead(
      "DELETE /x HTTP/1.1\r\nHost: h\r\nRange: bytes=0-1\r\nAccept-Encoding: "
      "br\r\nX-Parkade-Range: forged\r\nX-Parkade-Accept-Encoding: forged\r\n\r\n");

  EXPECT_EQ(ToText(head, CheckRequestHead(head)),
            "DELETE /x HTTP/1.1\r\nhost: h\r\nx-parkade-range: "
            "bytes=0-1\r\nx-parkade-accept-encoding: br\r\ncontent-length: "
            "0\r\n\r\n");
}

TEST(RequestHead, TakesTheHostFromATargetThatNamesIt) {
  const RequestHead head =
      ParseRequestHead("GET http://127.0.0.1:80/a?b=http://c HTTP/1.1\r\nHost: h\r\n\r\n");
  EXPECT_EQ(head.target, "/a?b=http://c");
  EXPECT_EQ(head.Find("host"), "127.0.0.1:80");

  EXPECT_EQ(ParseRequestHead("GET http://h HTTP/1.1\r\nHost: h\r\n\r\n").target, "/");
  EXPECT_EQ(ParseRequestHead("GET http://h?a HTTP/1.1\r\nHost: h\r\n\r\n").target, "/?a");
  EXPECT_THROW(CheckRequestHead(ParseRequestHead("GET http://h/ HTTP/1.1\r\n\r\n")), HttpError);
}

TEST(RequestHead, OfAnActionNeedsNoLength) {
  for (const char* path :
       {"/api/v1/jobs/0/cancel", "/api/v1/jobs/0/retry", "/api/v1/sites/lot/maps"}) {
    const RequestHead head =
        ParseRequestHead(std::string("POST ") + path + " HTTP/1.1\r\nHost: h\r\n\r\n");
    EXPECT_EQ(CheckRequestHead(head), 0) << path;
  }
}

struct RangeCase {
  const char* field;
  std::int64_t first, length;
};

TEST(ByteRange, IsReadAsTheStandardSays) {
  for (const RangeCase& c :
       {RangeCase{"bytes=0-0", 0, 1}, RangeCase{"bytes=0-99", 0, 100}, RangeCase{"bytes=5-", 5, 95},
        RangeCase{"bytes=-10", 90, 10}, RangeCase{"bytes=-1000", 0, 100},
        RangeCase{"bytes=50-1000", 50, 50}, RangeCase{"bytes=99-99999999999999999999", 99, 1}}) {
    const auto range = ParseByteRange(c.field, 100);
    ASSERT_TRUE(range.has_value()) << c.field;
    EXPECT_EQ(range->first, c.first) << c.field;
    EXPECT_EQ(range->length, c.length) << c.field;
  }
}

TEST(ByteRange, IsIgnoredWhenItIsNone) {
  for (const char* field : {"", "bytes", "bytes=", "bytes=-", "bytes=a-b", "bytes=5-2", "items=0-1",
                            "bytes=1-2-3", "bytes= 0-1"})
    EXPECT_FALSE(ParseByteRange(field, 100).has_value()) << field;
}

TEST(ByteRange, IsRefusedBeyondTheEnd) {
  for (const char* field :
       {"bytes=100-", "bytes=100-200", "bytes=-0", "bytes=0-1,5-6", "bytes=99999999999999999999-"})
    EXPECT_THROW(ParseByteRange(field, 100), HttpError) << field;
  EXPECT_THROW(ParseByteRange("bytes=0-", 0), HttpError);
}

TEST(ListenAddress, IsHostAndPort) {
  EXPECT_EQ(ParseListenAddress("127.0.0.1:8080").port, 8080);
  EXPECT_EQ(ParseListenAddress("[::1]:0").host, "::1");
  EXPECT_EQ(ParseListenAddress("localhost:65535").host, "localhost");
  for (const char* text : {"", "8080", ":8080", "127.0.0.1", "127.0.0.1:", "127.0.0.1:x",
                           "127.0.0.1:65536", "::1:80", "h:-1"})
    EXPECT_THROW(ParseListenAddress(text), Error) << text;
}

TEST(ListenAddress, KnowsWhatStaysOnThisMachine) {
  for (const char* host : {"127.0.0.1", "127.255.0.1", "::1", "localhost"})
    EXPECT_TRUE(IsLoopback(host)) << host;
  for (const char* host :
       {"0.0.0.0", "::", "192.168.1.1", "128.0.0.1", "example.org", "127.0.0.1.example.org"})
    EXPECT_FALSE(IsLoopback(host)) << host;
}

}  // namespace
}  // namespace parkade
