#include "server/map_folder/surface_file.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/files/file.h"
#include "tests/mapping/worlds/test_surfaces.h"
#include "tests/server/store/temporary_store.h"

namespace parkade {
namespace {

class SurfaceFile : public testing::Test {
 protected:
  std::string Message() const {
    try {
      ReadSurface(file_);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
  TemporaryRoot root_;
  const std::filesystem::path file_ = root_.path() / "surface.bin";
};

SurfaceMap HillySurface() {
  SurfaceMap surface = MakeSurface(40, 30, 0.05, [](double x, double y) { return 3 * x - 2 * y; });
  for (SurfaceCell& cell : surface.cells)
    cell.x -= 20, cell.free_belief = static_cast<float>(cell.y) / 30;
  return surface;
}

TEST_F(SurfaceFile, HoldsHeightsSigmasAndBeliefs) {
  const SurfaceMap surface = HillySurface();
  WriteSurface(surface, file_);
  const SurfaceMap read = ReadSurface(file_);
  EXPECT_EQ(read.cell_size, surface.cell_size);
  ASSERT_EQ(read.cells.size(), surface.cells.size());
  for (size_t i = 0; i < read.cells.size(); ++i) {
    EXPECT_EQ(read.cells[i].x, surface.cells[i].x);
    EXPECT_EQ(read.cells[i].y, surface.cells[i].y);
    EXPECT_NEAR(read.cells[i].height, surface.cells[i].height, 0.0006);
    EXPECT_NEAR(read.cells[i].height_sigma, surface.cells[i].height_sigma, 0.0006);
    EXPECT_NEAR(read.cells[i].free_belief, surface.cells[i].free_belief, 0.0021);
  }
  EXPECT_LT(std::filesystem::file_size(file_), 4 * surface.cells.size());
}

TEST_F(SurfaceFile, MayBeOfAnEmptyMap) {
  WriteSurface(SurfaceMap{0.05, {}}, file_);
  EXPECT_TRUE(ReadSurface(file_).cells.empty());
}

TEST_F(SurfaceFile, IsRefusedInOneSentenceWhereDamaged) {
  WriteSurface(HillySurface(), file_);
  const std::string bytes = ReadFile(file_);
  for (const size_t at : {bytes.size() / 2, bytes.size() - 2}) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x55);
    WriteFileAtomically(file_, damaged);
    EXPECT_EQ(Message(), "'surface.bin' cannot be used: it is damaged") << at;
  }
  WriteFileAtomically(file_, std::string_view(bytes).substr(0, bytes.size() - 40));
  EXPECT_EQ(Message(), "'surface.bin' cannot be used: it is damaged");
  WriteFileAtomically(file_, std::string_view("ply"));
  EXPECT_EQ(Message(), "'surface.bin' cannot be used: it holds no surface");
  std::string newer = bytes;
  newer[15] = 9;
  WriteFileAtomically(file_, newer);
  EXPECT_NE(Message().find("is of version 9, this program reads 1"), std::string::npos)
      << Message();
}

}  // namespace
}  // namespace parkade
