#include "tests/server/http/raw_client.h"
#include "tests/server/http/running_service.h"

namespace parkade {
namespace {

using httplib::Headers;

class Tus : public RunningService {
 protected:
  static constexpr const char* kPart = "application/offset+octet-stream";

  httplib::Result Create(std::int64_t length, Headers headers = {}, const std::string& part = "") {
    headers.emplace("Tus-Resumable", "1.0.0");
    headers.emplace("Upload-Length", std::to_string(length));
    return client().Post("/api/v1/uploads", headers, part, part.empty() ? "" : kPart);
  }
  std::string Address(std::int64_t length) { return Create(length)->get_header_value("Location"); }
  httplib::Result Append(const std::string& address, std::int64_t offset, const std::string& part,
                         Headers headers = {}) {
    headers.emplace("Tus-Resumable", "1.0.0");
    headers.emplace("Upload-Offset", std::to_string(offset));
    return client().Patch(address, headers, part, kPart);
  }
  httplib::Result Head(const std::string& address) {
    return client().Head(address, {{"Tus-Resumable", "1.0.0"}});
  }
};

TEST_F(Tus, SaysWhatItSpeaks) {
  const auto answer = client().Options("/api/v1/uploads");
  EXPECT_EQ(answer->status, 204);
  EXPECT_EQ(answer->get_header_value("Tus-Version"), "1.0.0");
  EXPECT_EQ(answer->get_header_value("Tus-Extension"),
            "creation,creation-with-upload,termination,checksum,expiration");

  const auto other = client().Post("/api/v1/uploads",
                                   {{"Tus-Resumable", "0.2.2"}, {"Upload-Length", "9"}}, "", "");
  ExpectProblem(other, 412, "unsupported_version");
  EXPECT_EQ(other->get_header_value("Tus-Version"), "1.0.0");
}

TEST_F(Tus, ALogInTwoPartsBecomesADriveOfItsSite) {
  // "filename a.bag,site lot"
  const auto created = Create(7, {{"Upload-Metadata", "filename YS5iYWc=,site bG90"}});
  ASSERT_EQ(created->status, 201) << created->body;
  EXPECT_EQ(created->get_header_value("Tus-Resumable"), "1.0.0");
  EXPECT_EQ(created->get_header_value("Upload-Offset"), "0");
  const std::string address = created->get_header_value("Location");

  const auto first = Append(address, 0, "log");
  EXPECT_EQ(first->status, 204) << first->body;
  EXPECT_EQ(first->get_header_value("Upload-Offset"), "3");
  EXPECT_TRUE(first->get_header_value("Upload-Expires").ends_with(" GMT"));
  const auto half = Head(address);
  EXPECT_EQ(half->status, 200);
  EXPECT_EQ(half->get_header_value("Upload-Offset"), "3");
  EXPECT_EQ(half->get_header_value("Upload-Length"), "7");
  EXPECT_EQ(half->get_header_value("Upload-Metadata"), "filename YS5iYWc=,site bG90");
  EXPECT_EQ(half->get_header_value("Cache-Control"), "no-store");

  const auto last = Append(address, 3, " ok\n");

  EXPECT_EQ(last->status, 204) << last->body;
  EXPECT_EQ(WaitForJob(last->get_header_value("Upload-Job")).at("state"), "done");
  const Json drive = Get("/api/v1/drives/" + last->get_header_value("Upload-Drive"));
  EXPECT_EQ(drive.at("filename"), "a.bag");
  EXPECT_EQ(drive.at("site"), "lot");
  EXPECT_EQ(Get(address).at("state"), "done");
}

TEST_F(Tus, TheFirstPartMayComeWithTheCreation) {
  const auto answer = Create(7, {}, "log ok\n");
  EXPECT_EQ(answer->status, 201) << answer->body;
  EXPECT_EQ(answer->get_header_value("Upload-Offset"), "7");
  EXPECT_FALSE(answer->get_header_value("Upload-Drive").empty());
}

TEST_F(Tus, RefusesWhatItCannotTake) {
  options_.disk_reserve = 0;
  ExpectProblem(Create(std::int64_t{1} << 60), 507, "disk_full");
  ExpectProblem(Create(0), 400, "invalid_input");
  ExpectProblem(Create(9, {{"Upload-Metadata", "filename not*base64"}}), 400, "invalid_input");
  ExpectProblem(Create(9, {{"Upload-Metadata", "site Li4vLi4="}}), 400, "invalid_input");
  ExpectProblem(Create(9, {{"Upload-Metadata", "rig bm9uZQ=="}}), 400, "invalid_input");
  ExpectProblem(Create(9, {{"Upload-Metadata", "sha256 bm9uZQ=="}}), 400, "invalid_input");
  const std::string address = Address(9);
  ExpectProblem(Append(address, 5, "log"), 409, "conflict");
  ExpectProblem(Append(address, 0, "log that is too long"), 400, "invalid_input");
  ExpectProblem(client().Patch(address, {{"Tus-Resumable", "1.0.0"}, {"Upload-Offset", "0"}}, "log",
                               "text/plain"),
                415, "unsupported_media_type");
  ExpectProblem(Append(address, 0, "log", {{"Upload-Checksum", "md5 AAAA"}}), 400, "invalid_input");
  ExpectProblem(
      Append(address, 0, "log", {{"Upload-Checksum", "sha1 2jmj7l5rSw0yVb/vlWAYkK/YBwk="}}), 460,
      "checksum_mismatch");
  ExpectProblem(Append("/api/v1/uploads/0123456789abcdef", 0, "log"), 404, "not_found");
  EXPECT_EQ(Head("/api/v1/uploads/0123456789abcdef")->status, 404);
  EXPECT_EQ(Head(address)->get_header_value("Upload-Offset"), "0");
}

TEST_F(Tus, AWholeThatIsNoLogIsRefusedForGood) {
  const std::string address = Address(4);
  const auto answer = Append(address, 0, "list");
  ExpectProblem(answer, 400, "invalid_input");
  EXPECT_NE(answer->body.find("the upload"), std::string::npos) << answer->body;
  EXPECT_EQ(Head(address)->status, 410);
  EXPECT_EQ(Get(address).at("state"), "refused");
  EXPECT_TRUE(Get("/api/v1/drives").at("items").empty());
}

TEST_F(Tus, WhoeverComesBackTakesOver) {
  const std::string log = "log ok\n" + std::string(999'993, 'x');
  const std::string address = Address(1'000'000);
  RawClient stuck(service_->port());
  stuck.Send("PATCH " + address +
             " HTTP/1.1\r\nHost: localhost\r\nTus-Resumable: 1.0.0\r\nUpload-Offset: "
             "0\r\nContent-Type: application/offset+octet-stream\r\nContent-Length: "
             "1000000\r\n\r\n" +
             log.substr(0, 200'000));
  // Before it holds the upload, HEAD would find it free.
  Eventually([&] {
    return client().Get("/metrics")->body.find("\nparkade_upload_bytes_total 200000\n") !=
           std::string::npos;
  });
  EXPECT_EQ(Get(address).at("offset"), 0) << "who only looks disturbs nobody";
  const auto start = std::chrono::steady_clock::now();

  const auto head = Head(address);

  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(8))
      << "not by patience, which is 10 s: a busy disk may take its time to sync";
  EXPECT_EQ(head->get_header_value("Upload-Offset"), "200000") << "what had come is there";
  EXPECT_EQ(Append(address, 200'000, log.substr(200'000))->status, 204);
}

TEST_F(Tus, IsTerminatedAndOverridden) {
  const std::string address = Address(7);
  Headers headers{{"Tus-Resumable", "1.0.0"}, {"Upload-Offset", "0"}};
  ExpectProblem(client().Post(address, headers, "log", kPart), 405, "method_not_allowed");
  headers.emplace("X-HTTP-Method-Override", "PATCH");
  EXPECT_EQ(client().Post(address, headers, "log", kPart)->status, 204);

  EXPECT_EQ(client().Delete(address, {{"Tus-Resumable", "1.0.0"}})->status, 204);

  EXPECT_EQ(Head(address)->status, 404);
  EXPECT_TRUE(std::filesystem::is_empty(options_.data / "uploads"));
}

}  // namespace
}  // namespace parkade
