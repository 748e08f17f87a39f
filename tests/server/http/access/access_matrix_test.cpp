#include <atomic>
#include <set>
#include <thread>

#include "server/http/route_table.h"
#include "tests/server/http/access/guarded_service.h"

namespace parkade {
namespace {

/// Somebody at the door, and what that one may do with things of the site "lot", which the token
/// "uploader" brought in.
struct Visitor {
  std::string name;
  std::set<Right> rights;
  bool knows_lot = true;
  bool is_for_all = true;
};

const std::set<Right> kNobody = {Right::kNone};
const std::set<Right> kLink = {Right::kNone, Right::kSeeMaps};
const std::set<Right> kViewer = {Right::kNone, Right::kSeeMaps, Right::kSee};
const std::set<Right> kUploader = {Right::kNone,   Right::kSeeMaps,   Right::kSee,
                                   Right::kUpload, Right::kOwnUpload, Right::kRunJob};
const std::set<Right> kSecondUploader = {Right::kNone, Right::kSeeMaps, Right::kSee,
                                         Right::kUpload};
const std::set<Right> kReviewer = {Right::kNone, Right::kSeeMaps, Right::kSee, Right::kRunJob,
                                   Right::kReview};
// Camera pictures are for none of them.
const std::set<Right> kAdmin = {Right::kNone,      Right::kSeeMaps, Right::kSee,    Right::kUpload,
                                Right::kOwnUpload, Right::kRunJob,  Right::kReview, Right::kAdmin};

const std::vector<Visitor> kVisitors = {
    {"nobody", kNobody, false, false},
    {"garbage", kNobody, false, false},
    {"expired", kNobody, false, false},
    {"revoked", kNobody, false, false},
    {"dead link", kNobody, false, false},
    {"link to other", kLink, false, false},
    {"link to lot", kLink, true, false},
    {"viewer of other", kViewer, false, false},
    {"uploader of other", kUploader, false, false},
    {"reviewer of other", kReviewer, false, false},
    {"admin of other", kAdmin, false, false},
    {"viewer", kViewer},
    {"second uploader", kSecondUploader},
    {"uploader", kUploader},
    {"reviewer", kReviewer},
    {"admin", kAdmin},
};

bool MayPass(const Visitor& visitor, const Route& route) {
  if (!visitor.rights.contains(route.right)) return false;
  if (route.reach == Reach::kPath) return visitor.knows_lot;
  return route.reach != Reach::kWhole || visitor.is_for_all;
}

class AccessMatrix : public GuardedService {
 protected:
  void SetUp() override {
    Become("admin");
    MapNow("log ok\n", "?filename=far.bag&site=other");
    Become("uploader");
    const Json job = MapNow("log ok\n");
    names_["{job}"] = job.at("id");
    names_["{drive}"] = job.at("drives").at(0);
    names_["{site}"] = "lot";
    names_["{version}"] = "1";
    names_["{alias}"] = "latest";
    names_["{file}"] = "map.glb";
    names_["{rig}"] = "car";
    const auto upload = Ask("POST", "/api/v1/uploads",
                            {{"Authorization", "Bearer " + tokens_.at("uploader")},
                             {"Tus-Resumable", "1.0.0"},
                             {"Upload-Length", "9"},
                             {"Upload-Metadata", "site bG90"}});
    ASSERT_EQ(upload->status, 201) << upload->body;
    const std::string location = upload->get_header_value("Location");
    names_["{upload}"] = location.substr(location.rfind('/') + 1);
    const auto set = Ask("POST", "/api/v1/upload-sets", "uploader",
                         R"({"site": "lot", "parts": [{"path": "a.bag", "bytes": 9}]})");
    ASSERT_EQ(set->status, 201) << set->body;
    names_["{set}"] = Json::parse(set->body).at("id");
    for (const auto& [name, site] :
         {std::pair("link to lot", "lot"), {"link to other", "other"}, {"dead link", "lot"}}) {
      const Json link = Share(site);
      tokens_[name] = link.at("token");
      names_["{share}"] = link.at("id");
    }
    EXPECT_EQ(Ask("DELETE", "/api/v1/shares/" + names_.at("{share}"), "admin")->status, 204);
    names_["{share}"] = Share("lot").at("id");
    tokens_["garbage"] = "parkade_token_" + std::string(43, 'a');
  }

  Json Share(const std::string& site) {
    const auto made = Ask("POST", "/api/v1/shares", "admin",
                          R"({"name": "the city", "days": 1, "site": ")" + site + "\"}");
    EXPECT_EQ(made->status, 201) << made->body;
    return Json::parse(made->body);
  }

  /// The route's address, of things that exist; where those would be gone afterwards, of none.
  std::string AddressOf(const Route& route, bool passes) const {
    std::string path(route.path);
    for (size_t begin = 0; (begin = path.find('{')) != std::string::npos;) {
      const std::string name = path.substr(begin, path.find('}') - begin + 1);
      const auto found = names_.find(name);
      const bool stays = !passes || route.method != "DELETE";
      path.replace(begin, name.size(),
                   found != names_.end() && stays ? found->second : "0000000000000000");
    }
    return path;
  }

  httplib::Headers HeadersOf(const Visitor& visitor) const {
    httplib::Headers headers = {{"Tus-Resumable", "1.0.0"},
                                {"Upload-Length", "9"},
                                {"Upload-Offset", "0"},
                                {"Upload-Metadata", "site b3RoZXI="},
                                {"X-HTTP-Method-Override", "PATCH"}};
    if (visitor.name != "nobody")
      headers.emplace("Authorization", "Bearer " + tokens_.at(visitor.name));
    return headers;
  }

  std::map<std::string, std::string> names_;
};

TEST_F(AccessMatrix, LetsNobodyWhereThatOneMayNot) {
  int asked = 0;
  for (const Visitor& visitor : kVisitors) {
    for (const Route& route : kRoutes) {
      if (route.method.empty() || route.path == "/api/v1/events") continue;
      if (route.path == "/api/v1/session" && visitor.rights == kNobody) continue;  // says who asks
      const bool passes = MayPass(visitor, route);
      std::string path = AddressOf(route, passes);
      if (route.method == "PUT" && path == "/api/v1/drives") path += "?site=other";
      const auto answer = Ask(std::string(route.method), path, HeadersOf(visitor));
      ASSERT_TRUE(answer) << route.method << " " << path;
      ++asked;
      const std::string what =
          visitor.name + ": " + std::string(route.method) + " " + path + " " + answer->body;
      const bool is_refused =
          answer->status == 401 || answer->status == 403 || answer->status == 429;
      if (passes) {
        EXPECT_FALSE(is_refused) << what << answer->status;
      } else {
        EXPECT_TRUE(is_refused || answer->status == 404) << what << answer->status;
      }
      if (visitor.rights == kNobody && route.right != Right::kNone) {
        EXPECT_TRUE(answer->status == 401 || answer->status == 429) << what << answer->status;
      }
    }
  }
  EXPECT_GE(asked, 600);
}

/// Hears events until one of a map of "other" comes.
class Listener {
 public:
  Listener(int port, const httplib::Headers& headers) : client_("127.0.0.1", port) {
    client_.set_read_timeout(60);
    thread_ = std::thread([this, headers] {
      client_.Get("/api/v1/events", headers, [this](const char* data, size_t size) {
        heard_.append(data, size);
        is_listening_ = true;
        return heard_.find("sites/other/maps") == std::string::npos;
      });
    });
  }
  bool is_listening() const { return is_listening_; }
  const std::string& Heard() {
    thread_.join();
    return heard_;
  }

 private:
  DescribedClient client_;
  std::string heard_;
  std::atomic<bool> is_listening_ = false;
  std::thread thread_;
};

TEST_F(AccessMatrix, HearsEventsOfKnownSitesOnly) {
  Listener all(service_->port(), As("viewer")), other(service_->port(), As("viewer of other"));
  Eventually([&] { return all.is_listening() && other.is_listening(); });
  Become("admin");
  MapNow("log ok once more\n");
  MapNow("log ok once more\n", "?filename=far.bag&site=other");
  const std::string of_all = all.Heard(), of_other = other.Heard();
  EXPECT_NE(of_all.find("sites/lot/maps"), std::string::npos) << of_all;
  EXPECT_NE(of_all.find("sites/other/maps"), std::string::npos) << of_all;
  EXPECT_NE(of_other.find("sites/other/maps"), std::string::npos) << of_other;
  EXPECT_EQ(of_other.find("lot"), std::string::npos) << of_other;
  EXPECT_EQ(Ask("GET", "/api/v1/events", "link to lot")->status, 403);
}

TEST_F(AccessMatrix, ListsNameKnownSitesOnly) {
  for (const char* list : {"/api/v1/sites", "/api/v1/drives", "/api/v1/jobs"}) {
    const auto answer = Ask("GET", list, "reviewer of other");
    ASSERT_EQ(answer->status, 200) << answer->body;
    EXPECT_EQ(Json::parse(answer->body).at("items").size(), 1u) << answer->body;
    EXPECT_NE(answer->body.find("other"), std::string::npos) << answer->body;
    EXPECT_EQ(answer->body.find("lot"), std::string::npos) << answer->body;
  }
  const Json shares =
      Json::parse(Ask("GET", "/api/v1/shares", "reviewer of other")->body).at("items");
  ASSERT_EQ(shares.size(), 1u);
  EXPECT_EQ(shares.at(0).at("site"), "other");
  EXPECT_EQ(Ask("GET", "/api/v1/drives?site=lot", "reviewer of other")->body,
            "{\"items\":[],\"next_cursor\":null}\n");
}

TEST_F(AccessMatrix, ForeignThingsAnswerAsWhatDoesNotExist) {
  const auto detail = [&](const std::string& path) {
    const auto answer = Ask("GET", path, "viewer of other");
    EXPECT_EQ(answer->status, 404) << answer->body;
    return Json::parse(answer->body).at("detail").get<std::string>();
  };
  EXPECT_EQ(detail("/api/v1/drives/" + names_.at("{drive}")),
            "there is no drive '" + names_.at("{drive}") + "'");
  EXPECT_EQ(detail("/api/v1/drives/0000000000000000"), "there is no drive '0000000000000000'");
  EXPECT_EQ(detail("/api/v1/sites/lot"), "there is no site 'lot'");
  EXPECT_EQ(detail("/api/v1/sites/nothing"), "there is no site 'nothing'");
}

TEST_F(AccessMatrix, PartsOfASetAreOfItsSite) {
  const auto answer = Ask("GET", "/api/v1/upload-sets/" + names_.at("{set}"), "uploader");
  const std::string part = Json::parse(answer->body).at("parts").at(0).at("upload");
  EXPECT_EQ(Ask("GET", part, "uploader")->status, 200);
  EXPECT_EQ(Ask("GET", part, "second uploader")->status, 403);
  EXPECT_EQ(Ask("GET", part, "uploader of other")->status, 404);
  ExpectProblem(Ask("POST", "/api/v1/upload-sets", "uploader of other",
                    R"({"site": "lot", "parts": [{"path": "a.bag", "bytes": 9}]})"),
                403, "forbidden");
}

TEST_F(AccessMatrix, WhoBringsSomethingInNamesASiteItMayKnow) {
  const auto put = [&](const std::string& query) {
    return Ask("PUT", "/api/v1/drives" + query, "uploader of other", "log ok\n");
  };
  ExpectProblem(put("?filename=a.bag&site=lot"), 403, "forbidden");
  ExpectProblem(put("?filename=a.bag"), 403, "forbidden");
  EXPECT_EQ(put("?filename=b.bag&site=other")->status, 201);
}

}  // namespace
}  // namespace parkade
