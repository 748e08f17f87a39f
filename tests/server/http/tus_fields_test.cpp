#include "server/http/tus_fields.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace parkade {
namespace {

TEST(TusFields, MetadataAreKeysWithTheirTexts) {
  EXPECT_TRUE(ParseTusMetadata("").empty());
  EXPECT_EQ(ParseTusMetadata("filename d29ybGQuYmFn, is_public ,site bG90"),
            (std::map<std::string, std::string>{
                {"filename", "world.bag"}, {"is_public", ""}, {"site", "lot"}}));
  for (const char* malformed : {",", "a YQ==,,b YQ==", "a YQ", "a Y===", "a YQ==,a YQ==", "a *aaa"})
    EXPECT_THROW(ParseTusMetadata(malformed), Error) << malformed;
}

TEST(TusFields, ChecksumsAreOfTheirAlgorithmsLength) {
  const PartChecksum checksum = ParseTusChecksum("sha1 Kq5sNclPz7QV2+lfQIuc6R7oRu0=");
  EXPECT_EQ(checksum.algorithm, "sha1");
  EXPECT_EQ(checksum.digest.size(), 20u);
  for (const char* malformed : {"", "sha1", "sha1 AAAA", "md5 AAAAAAAAAAAAAAAAAAAAAA==",
                                "sha256 Kq5sNclPz7QV2+lfQIuc6R7oRu0="})
    EXPECT_THROW(ParseTusChecksum(malformed), Error) << malformed;
}

TEST(TusFields, LengthsAreNumbers) {
  EXPECT_EQ(ParseTusLength("Upload-Length", "9000000000000"), 9'000'000'000'000);
  for (const char* malformed : {"", "-1", "1e3", " 1", "1 ", "0x10", "99999999999999999999"})
    EXPECT_THROW(ParseTusLength("Upload-Length", malformed), Error) << malformed;
}

TEST(TusFields, DatesAreThoseOfHttp) {
  EXPECT_EQ(HttpDate("2026-11-26T23:17:26.123Z"), "Thu, 26 Nov 2026 23:17:26 GMT");
  EXPECT_EQ(HttpDate("2028-02-29T00:00:00.000Z"), "Tue, 29 Feb 2028 00:00:00 GMT");
}

}  // namespace
}  // namespace parkade
