#include "server/ingest/files/euroc_csv.h"

#include <gtest/gtest.h>

#include "tests/server/ingest/drive/euroc_folder.h"

namespace parkade {
namespace {

/// What a table of an IMU holds, and what of it cannot be read.
struct Table {
  std::vector<EurocLine> lines;
  BadLines bad;
  TableFormat format;
};

Table Read(const std::string& text, TableKind kind = TableKind::kImu) {
  const TestFolder folder;
  const std::filesystem::path file = folder.path() / "data.csv";
  WriteText(file, text);
  Table table;
  table.format = FormatOf(file, kind);
  EurocCsv csv(file, table.format);
  while (auto line = csv.Next()) table.lines.push_back(std::move(*line));
  table.bad = csv.bad_lines();
  return table;
}

TEST(EurocCsv, StampsInOtherUnitsComeOutInNanoseconds) {
  const struct {
    const char *first, *second;
    StampUnit unit;
    std::int64_t ns;
  } cases[] = {
      {"1403715273262142976", "1403715273267142976", StampUnit::kNanoseconds, 1403715273262142976},
      {"1403715273262142", "1403715273267142", StampUnit::kMicroseconds, 1403715273262142000},
      {"1403715273262", "1403715273267", StampUnit::kMilliseconds, 1403715273262000000},
      {"1403715273.262142976", "1403715273.267142976", StampUnit::kSeconds, 1403715273262142976},
      {"1.403715273262e+18", "1.403715273267e+18", StampUnit::kNanoseconds, 1403715273262000000},
      {"1.403715273262e9", "1.403715273267e9", StampUnit::kSeconds, 1403715273262000000},
      {"2014-06-25 16:14:33.262142976", "2014-06-25 16:14:33.267", StampUnit::kNanoseconds,
       1403712873262142976},
      // Since the computer was started: told by the step of 5 ms.
      {"1000000000000", "1000005000000", StampUnit::kNanoseconds, 1000000000000},
      {"1000000000", "1000005000", StampUnit::kMicroseconds, 1000000000000},
      {"1000000", "1000005", StampUnit::kMilliseconds, 1000000000000},
      {"1000.000", "1000.005", StampUnit::kSeconds, 1000000000000},
  };
  for (const auto& c : cases) {
    const Table table = Read(std::string(c.first) + ",1,2,3,4,5,6\n" + c.second + ",1,2,3,4,5,6\n");
    ASSERT_EQ(table.lines.size(), 2u) << c.first;
    EXPECT_EQ(table.lines[0].stamp.ns, c.ns) << c.first;
    EXPECT_EQ(table.format.unit, c.unit) << c.first;
  }
}

TEST(EurocCsv, OneFixASecondInMicrosecondsIsNoThousandInNanoseconds) {
  const Table table = Read("5000000,48,11,500\n6000000,48,11,500\n", TableKind::kGnss);

  EXPECT_EQ(table.lines[1].stamp.ns, 6'000'000'000);
}

TEST(EurocCsv, FieldsMayBePartedByAnything) {
  for (const char* row :
       {"1000000000000,0.5,-2e-3,3", "1000000000000;0.5;-2e-3;3", "1000000000000;0,5;-2e-3;3",
        "1000000000000\t0.5\t-2e-3\t3", "1000000000000 0.5  -2e-3   3",
        "\"1000000000000\",\"0.5\",-2e-3,3", " 1000000000000 , 0.5 , -2e-3 , 3 "}) {
    const Table table = Read(std::string("\xEF\xBB\xBFtime;x\r\n") + row + "\r\n");
    ASSERT_EQ(table.lines.size(), 1u) << row;
    EXPECT_EQ(table.lines[0].text, "1000000000000,0.5,-2e-3,3") << row;
    EXPECT_EQ(table.bad.count, 0u) << row;
  }
}

TEST(EurocCsv, ColumnsAreFoundByTheirNamesWhereTheseTellAll) {
  const Table imu = Read(
      "index,Time (s),acc_x,acc_y,acc_z,gyro_x,gyro_y,gyro_z\n"
      "0,10.00,1,2,3,4,5,6\n1,10.01,1,2,3,4,5,6\n");
  const Table fixes =
      Read("time,alt,lat,lon,sigma_e,sigma_n,sigma_u\n1.0,500,48,11,1,2,3\n", TableKind::kGnss);
  const Table wheels = Read("stamp,yaw_rate,speed\n1.0,0.25,1.5\n", TableKind::kWheels);
  const Table usual = Read(
      "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad "
      "s^-1],a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n1,1\n");

  const Table receiver =
      Read("# t_s,lat_deg,lon_deg,speed (m/s; over ground),alt_m\n46408.5,37.7,-122.4,7.8,33.3\n",
           TableKind::kGnss);

  EXPECT_EQ(receiver.lines.at(0).text, "46408.5,37.7,-122.4,33.3");
  ASSERT_EQ(imu.lines.size(), 2u);
  EXPECT_EQ(imu.lines[0].text, "10.00,4,5,6,1,2,3");
  EXPECT_EQ(imu.lines[0].stamp.ns, 10'000'000'000);
  EXPECT_EQ(fixes.lines[0].text, "1.0,48,11,500,1,2,3");
  EXPECT_EQ(wheels.lines[0].text, "1.0,1.5,0.25");
  EXPECT_TRUE(usual.format.columns.empty());
}

TEST(EurocCsv, ALineThatCannotBeReadIsNamed) {
  const Table table = Read("time,x\n10.00,1\nbanana,2\n10.02,3\n10:03,4\n");

  EXPECT_EQ(table.lines.size(), 2u);
  EXPECT_EQ(table.bad.count, 2u);
  EXPECT_EQ(table.bad.first, "line 3, 'banana,2'");
}

}  // namespace
}  // namespace parkade
