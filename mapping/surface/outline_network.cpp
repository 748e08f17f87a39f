#include "mapping/surface/outline_network.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

#include "core/math/fast_floor.h"
#include "core/parallel.h"
#include "mapping/networks/builtin_network.h"
#include "mapping/networks/network_copies.h"
#include "mapping/surface/deck_rasters.h"
#include "mapping/surface/outline_features.h"

namespace parkade {
namespace {

using PaintedCell = SurfacePainter::PaintedCell;

constexpr int kSide = 384;               // pixels of a block at most
constexpr int kAlign = 16;               // pixels: what blocks begin and end at
constexpr std::size_t kMinCells = 2000;  // of a deck: 5 m^2, less tells nothing
constexpr float kStep = 1.0F / 64;       // corrections are multiples of it: rounding does not show
constexpr float kUnsure = 0.6F;          // log-odds: CompareSurfaces is sure from 0.62 on

/// A square of a deck: what is kept of it, in pixels of the deck's features.
struct Block {
  const DeckRaster* deck = nullptr;
  cv::Rect core;
};

bool IsAnySeen(std::span<const PaintedCell> cells, const Block& block) {
  const cv::Rect core(block.core.tl() * kOutlineFactor, block.core.size() * kOutlineFactor);
  const cv::Mat index = block.deck->index(core);
  return std::any_of(index.begin<int>(), index.end<int>(),
                     [&](int i) { return i >= 0 && cells[static_cast<size_t>(i)].is_seen; });
}

/// Blocks lie on one grid of the whole site, which is what the network's coarser levels go by; they
/// end with the deck.
std::vector<Block> CutIntoBlocks(std::span<const PaintedCell> cells,
                                 std::span<const DeckRaster> decks) {
  std::vector<Block> blocks;
  for (const DeckRaster& deck : decks) {
    const cv::Point origin(deck.origin.x() / kOutlineFactor, deck.origin.y() / kOutlineFactor);
    const cv::Rect whole = OutlineWindow(deck) + origin;
    for (int y = kSide * FloorDivide(whole.y, kSide); y < whole.br().y; y += kSide)
      for (int x = kSide * FloorDivide(whole.x, kSide); x < whole.br().x; x += kSide) {
        const Block block{&deck, (cv::Rect(x, y, kSide, kSide) & whole) - origin};
        if (IsAnySeen(cells, block)) blocks.push_back(block);
      }
  }
  return blocks;
}

/// What the network adds to the log-odds of the block's cells: CV_32FC1, a pixel per cell.
cv::Mat CorrectionsOf(std::span<const PaintedCell> cells, const Block& block,
                      NetworkCopies& network) {
  constexpr int kReach = OutlineNetwork::kReach;
  const cv::Rect window(block.core.x - kReach, block.core.y - kReach, block.core.width + 2 * kReach,
                        block.core.height + 2 * kReach);
  const cv::Mat output = network.Run(OutlineFeatures(cells, *block.deck, window));
  cv::Mat fine;
  cv::resize(output.reshape(1, window.height), fine, {}, kOutlineFactor, kOutlineFactor,
             cv::INTER_LINEAR);
  return fine(
      cv::Rect(cv::Point(kReach, kReach) * kOutlineFactor, block.core.size() * kOutlineFactor));
}

/// What of a correction counts.
float BeyondDoubt(float correction) {
  return std::copysign(std::max(std::abs(correction) - OutlineNetwork::kDoubt, 0.0F), correction);
}

/// What observations were not sure of is corrected, but nobody is surer of it.
float Corrected(float belief, float correction) {
  const float log_odds = std::log(belief / (1 - belief));
  const float corrected = std::clamp(log_odds + kStep * std::round(BeyondDoubt(correction) / kStep),
                                     std::min(log_odds, -kUnsure), std::max(log_odds, kUnsure));
  return 1 / (1 + std::exp(-corrected));
}

}  // namespace

OutlineNetwork::OutlineNetwork()
    : copies_(std::make_unique<NetworkCopies>(std::string(BuiltinOutlineNetwork()),
                                              NetworkRuntime::kLayered)) {}

OutlineNetwork::~OutlineNetwork() = default;

void OutlineNetwork::Refine(const SurfaceLinks& links, std::vector<PaintedCell>& cells) const {
  const std::vector<DeckRaster> decks =
      CutIntoDecks(cells, links, kAlign * kOutlineFactor, kMinCells);
  const std::vector<Block> blocks = CutIntoBlocks(cells, decks);
  const std::vector<cv::Mat> corrections = ParallelMap(
      blocks.size(), [&](size_t i) { return CorrectionsOf(cells, blocks[i], *copies_); });
  for (size_t k = 0; k < blocks.size(); ++k) {
    const cv::Point corner = kOutlineFactor * blocks[k].core.tl();
    for (int row = 0; row < corrections[k].rows; ++row)
      for (int column = 0; column < corrections[k].cols; ++column) {
        const int i = blocks[k].deck->index.at<int>(corner.y + row, corner.x + column);
        if (i < 0) continue;
        PaintedCell& cell = cells[static_cast<size_t>(i)];
        if (cell.is_seen && !cell.is_driven)
          cell.cell.free_belief =
              Corrected(cell.cell.free_belief, corrections[k].at<float>(row, column));
      }
  }
}

}  // namespace parkade
