#include "server/store/review/measurements.h"

#include <limits>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/geo.h"
#include "server/store/review/measurement_export.h"
#include "tests/server/store/review/published_site.h"

namespace parkade {
namespace {

using Points = std::vector<std::array<double, 3>>;
using Kind = MeasurementKind;

class Measurements : public PublishedSite {
 protected:
  Measurement Save(Kind kind, const Points& points, const std::string& title = "gate",
                   std::int64_t version = 1) {
    Measurement measurement;
    measurement.site = "lot";
    measurement.version = version;
    measurement.kind = kind;
    measurement.title = title;
    measurement.points = points;
    return SaveMeasurement(store_, measurement, "ann");
  }
  ErrorCode CodeOf(Kind kind, const Points& points) {
    return ErrorOf([&] { Save(kind, points); }).code();
  }
  std::vector<PlacedMeasurement> Placed(std::optional<std::int64_t> version = std::nullopt) {
    return store_.database.Read(
        [&](Connection& connection) { return PlacedMeasurements(connection, "lot", version); });
  }
};

TEST_F(Measurements, HaveValues) {
  const auto value = [&](Kind kind, const Points& points) {
    return ValueOf(Save(kind, points)).value;
  };
  EXPECT_DOUBLE_EQ(value(Kind::kDistance, {{0, 0, 0}, {3, 4, 0}, {3, 4, 12}}), 17);
  EXPECT_DOUBLE_EQ(value(Kind::kArea, {{1e6, 1e6, 0}, {1e6 + 4, 1e6, 1}, {1e6 + 4, 1e6 + 3, 2}}),
                   6);
  EXPECT_DOUBLE_EQ(value(Kind::kArea, {{0, 0, 0}, {0, 2, 0}, {2, 2, 0}, {2, 0, 0}}), 4)
      << "clockwise";
  EXPECT_DOUBLE_EQ(value(Kind::kHeight, {{0, 0, 1}, {9, 9, -1.5}}), -2.5);
  EXPECT_DOUBLE_EQ(value(Kind::kSlope, {{0, 0, 0}, {6, 8, 1}}), 10);
  EXPECT_DOUBLE_EQ(value(Kind::kSection, {{0, 0, 0}, {3, 4, 100}}), 5);
}

TEST_F(Measurements, HavePointsThatMakeSense) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(CodeOf(Kind::kDistance, {}), ErrorCode::kInvalidInput);
  EXPECT_EQ(CodeOf(Kind::kDistance, {{0, 0, 0}}), ErrorCode::kInvalidInput);
  EXPECT_EQ(CodeOf(Kind::kArea, {{0, 0, 0}, {1, 1, 1}}), ErrorCode::kInvalidInput);
  EXPECT_EQ(CodeOf(Kind::kHeight, {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}), ErrorCode::kInvalidInput);
  EXPECT_EQ(CodeOf(Kind::kSlope, {{0, 0, 0}, {0, 0, 9}}), ErrorCode::kInvalidInput);
  EXPECT_EQ(CodeOf(Kind::kDistance, {{0, 0, 0}, {nan, 0, 0}}), ErrorCode::kInvalidInput);
  EXPECT_EQ(CodeOf(Kind::kDistance, {{0, 0, 0}, {1e300, 0, 0}}), ErrorCode::kInvalidInput);
  EXPECT_EQ(CodeOf(Kind::kDistance, Points(201)), ErrorCode::kInvalidInput);
  EXPECT_EQ(ErrorOf([&] { Save(Kind::kHeight, Points(2), "a\nb"); }).code(),
            ErrorCode::kInvalidInput);
  EXPECT_EQ(ErrorOf([&] { Save(Kind::kHeight, Points(2), "gate", 7); }).code(),
            ErrorCode::kNotFound);
  EXPECT_TRUE(Placed().empty());
}

TEST_F(Measurements, AreSavedAndDeleted) {
  const Points points = {{0.1, 0.2, 0.3}, {1.0 / 3, 2, 3}};
  const Measurement saved = Save(Kind::kDistance, points);
  EXPECT_EQ(saved.points, points) << "to the last digit";
  EXPECT_EQ(saved.author, "ann");
  PublishAgain();
  Save(Kind::kDistance, points, "later", 2);
  EXPECT_EQ(Placed().size(), 2u);
  EXPECT_EQ(Placed(2).size(), 1u);

  RemoveMeasurement(store_, "lot", saved.id);
  EXPECT_EQ(Placed().size(), 1u);
  EXPECT_EQ(ErrorOf([&] { RemoveMeasurement(store_, "lot", saved.id); }).code(),
            ErrorCode::kNotFound);
}

TEST_F(Measurements, AreBoundedPerSite) {
  for (int i = 0; i < 1000; ++i)
    store_.database.Write([&](Connection& connection) {
      Measurement measurement{0, NewId(), "lot", 1, Kind::kHeight, "", Points(2), "ann", "now"};
      InsertMeasurement(connection, measurement);
    });
  EXPECT_EQ(ErrorOf([&] { Save(Kind::kHeight, Points(2)); }).code(), ErrorCode::kConflict);
}

TEST_F(Measurements, AreExportedInTheSiteFrameWithoutADatum) {
  Save(Kind::kArea, {{0, 0, 0}, {4, 0, 0}, {4, 3, 0}});

  const auto json = nlohmann::json::parse(FormatGeoJson(Placed()));
  const auto& feature = json.at("features").at(0);
  EXPECT_EQ(feature.at("properties").at("frame"), "site");
  EXPECT_EQ(feature.at("properties").at("value"), 6);
  EXPECT_EQ(feature.at("properties").at("unit"), "m2");
  EXPECT_EQ(feature.at("geometry").at("type"), "Polygon");
  EXPECT_EQ(feature.at("geometry").at("coordinates"),
            nlohmann::json::parse("[[[0,0,0],[4,0,0],[4,3,0],[0,0,0]]]"))
      << "closed";
}

TEST_F(Measurements, AreExportedWhereTheyLieOnEarth) {
  report_ =
      R"({"datum": {"latitude_deg": 48.1, "longitude_deg": 11.5, "altitude": 500}, "bounds": null, "drives": []})";
  PublishAgain();
  Save(Kind::kHeight, {{0, 0, 0}, {100, 200, 3}}, "ramp", 2);

  const auto json = nlohmann::json::parse(FormatGeoJson(Placed()));
  const auto end = json.at("features").at(0).at("geometry").at("coordinates").at(1);
  const Eigen::Vector3d back = SiteFromGeodetic({48.1, 11.5, 500}, end.at(1), end.at(0), end.at(2));
  EXPECT_LT((back - Eigen::Vector3d(100, 200, 3)).norm(), 1e-6);
  EXPECT_EQ(json.at("features").at(0).at("geometry").at("type"), "LineString");
  EXPECT_NE(FormatCsv(Placed()).find(",1,0.0000,0.0000,0.0000,48.100000000,11.500000000,500.000"),
            std::string::npos)
      << FormatCsv(Placed());
}

TEST_F(Measurements, AreExportedAsALinePerPoint) {
  const Measurement saved = Save(Kind::kHeight, {{0, 0, 1}, {1, 2, 3.5}}, "a \"gate\", red");

  const std::string head =
      saved.id + ",height,\"a \"\"gate\"\", red\",1,2.5000,m,\"ann\"," + saved.created_at + ",";
  EXPECT_EQ(FormatCsv(Placed()),
            "id,kind,title,version,value,unit,author,created_at,point,x,y,z,latitude,longitude,"
            "height\r\n" +
                head + "1,0.0000,0.0000,1.0000,,,\r\n" + head + "2,1.0000,2.0000,3.5000,,,\r\n");
}

TEST_F(Measurements, AreNoFormulas) {
  Save(Kind::kHeight, Points(2), "=HYPERLINK(\"http://x\")");
  EXPECT_NE(FormatCsv(Placed()).find(",\"'=HYPERLINK(\"\"http://x\"\")\","), std::string::npos);
}

}  // namespace
}  // namespace parkade
