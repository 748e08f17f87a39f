#include "server/store/rig_store.h"
#include "tests/server/http/running_service.h"

namespace parkade {
namespace {

class Rigs : public RunningService {
 protected:
  httplib::Result PutZip(const RigFiles& files) {
    return client().Put("/api/v1/rigs/car", PackRig(files), "application/zip");
  }

  const RigFiles rig_ = {{"camchain-imucam.yaml", "cam0: {}"},
                         {"imu0.yaml", "rostopic: /imu"},
                         {"vehicle.yaml", "wheelbase: 2.7"}};
};

TEST_F(Rigs, AreStoredAsAZipAndGivenBack) {
  const auto stored = PutZip(rig_);
  ASSERT_EQ(stored->status, 201) << stored->body;
  EXPECT_EQ(Json::parse(stored->body).at("files").size(), 3u);

  const auto found = client().Get("/api/v1/rigs/car");
  EXPECT_EQ(found->get_header_value("Content-Type"), "application/zip");
  EXPECT_EQ(UnpackRig(found->body), rig_);
  EXPECT_EQ(client()
                .Get("/api/v1/rigs/car", {{"If-None-Match", found->get_header_value("ETag")}})
                ->status,
            304);
  EXPECT_EQ(PutZip(rig_)->status, 200);
  EXPECT_EQ(Get("/api/v1/rigs").at("items").size(), 1u);
}

TEST_F(Rigs, AreStoredAsAForm) {
  client();
  std::string body;
  for (const auto& [name, content] : rig_)
    body += "--b\r\nContent-Disposition: form-data; name=\"" + name + "\"; filename=\"" + name +
            "\"\r\n\r\n" + content + "\r\n";
  const auto stored =
      client().Put("/api/v1/rigs/car", body + "--b--\r\n", "multipart/form-data; boundary=b");

  ASSERT_EQ(stored->status, 201) << stored->body;
  EXPECT_EQ(UnpackRig(client().Get("/api/v1/rigs/car")->body), rig_);
}

TEST_F(Rigs, AreCheckedOnArrival) {
  RigFiles wrong = rig_;
  wrong["imu0.yaml"] = "nothing";
  ExpectProblem(PutZip(wrong), 400, "invalid_input");
  wrong.erase("imu0.yaml");
  ExpectProblem(PutZip(wrong), 400, "invalid_input");
  ExpectProblem(client().Put("/api/v1/rigs/car", "no zip", "application/zip"), 400,
                "invalid_input");
  ExpectProblem(client().Put("/api/v1/rigs/car", "", "application/zip"), 400, "invalid_input");
  ExpectProblem(
      client().Put("/api/v1/rigs/car", "--b\r\nnonsense", "multipart/form-data; boundary=b"), 400,
      "invalid_input");
  ExpectProblem(client().Put("/api/v1/rigs/.car", PackRig(rig_), "application/zip"), 404,
                "not_found");
  ExpectProblem(client().Get("/api/v1/rigs/car"), 404, "not_found");
  EXPECT_TRUE(Files().empty());
}

TEST_F(Rigs, GoWithTheirDrives) {
  PutZip(rig_);
  std::filesystem::path seen;
  const auto answer = Upload("log ok\n", "?filename=a.bag&site=lot&rig=car");
  ASSERT_EQ(answer->status, 201) << answer->body;
  EXPECT_EQ(Json::parse(answer->body).at("drive").at("rig"), "car");
}

}  // namespace
}  // namespace parkade
