#include "mapping/outline_network.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

#include "core/floor_of.h"
#include "core/parallel.h"
#include "mapping/builtin_network.h"
#include "mapping/deck_rasters.h"
#include "mapping/network_copies.h"
#include "mapping/outline_features.h"

namespace parkade {
namespace {

using PaintedCell = SurfacePainter::PaintedCell;

constexpr int kCore = 256;                                  // pixels of a block that are kept
constexpr int kBlock = kCore + 2 * OutlineNetwork::kReach;  // that the network sees
constexpr std::size_t kMinCells = 2000;                     // of a deck: 5 m^2, less tells nothing
constexpr float kStep = 1.0F / 64;                          // corrections are multiples of it: rounding does not show

/// A square of a deck: what is kept of it, in pixels of the deck's features.
struct Block {
  const DeckRaster* deck = nullptr;
  cv::Rect core;
};

bool IsAnySeen(std::span<const PaintedCell> cells, const Block& block) {
  const cv::Rect core = block.core & OutlineWindow(*block.deck);
  const cv::Mat index = block.deck->index(cv::Rect(core.tl() * kOutlineFactor, core.size() * kOutlineFactor));
  return std::any_of(index.begin<int>(), index.end<int>(),
                     [&](int i) { return i >= 0 && cells[static_cast<size_t>(i)].is_seen; });
}

/// Blocks lie on one grid of the whole site, so that a cell is always at the same place of its block.
std::vector<Block> CutIntoBlocks(std::span<const PaintedCell> cells, std::span<const DeckRaster> decks) {
  std::vector<Block> blocks;
  for (const DeckRaster& deck : decks) {
    const cv::Size size = OutlineWindow(deck).size();
    const auto first = [](int origin) {
      return kCore * FloorDivide(origin / kOutlineFactor, kCore) - origin / kOutlineFactor;
    };
    for (int row = first(deck.origin.y()); row < size.height; row += kCore)
      for (int column = first(deck.origin.x()); column < size.width; column += kCore) {
        const Block block{&deck, {column, row, kCore, kCore}};
        if (IsAnySeen(cells, block)) blocks.push_back(block);
      }
  }
  return blocks;
}

float Corrected(float belief, float correction) {
  const float log_odds = std::log(belief / (1 - belief));
  return 1 / (1 + std::exp(-(log_odds + kStep * std::round(correction / kStep))));
}

}  // namespace

class OutlineNetwork::Copies : public NetworkCopies {
 public:
  using NetworkCopies::NetworkCopies;
};

OutlineNetwork::OutlineNetwork() : copies_(std::make_unique<Copies>(std::string(BuiltinOutlineNetwork()))) {}

OutlineNetwork::~OutlineNetwork() = default;

void OutlineNetwork::Refine(double max_step, std::vector<PaintedCell>& cells) const {
  const std::vector<DeckRaster> decks = CutIntoDecks(cells, max_step, kOutlineFactor, kMinCells);
  const std::vector<Block> blocks = CutIntoBlocks(cells, decks);
  const std::vector<cv::Mat> corrections = ParallelMap(blocks.size(), [&](size_t i) {
    const cv::Rect& core = blocks[i].core;
    const cv::Rect window(core.x - kReach, core.y - kReach, kBlock, kBlock);
    const cv::Mat output = copies_->Run(OutlineFeatures(cells, *blocks[i].deck, window));
    cv::Mat fine;
    cv::resize(cv::Mat(kBlock, kBlock, CV_32F, const_cast<float*>(output.ptr<float>(0, 0))), fine, {}, kOutlineFactor,
               kOutlineFactor, cv::INTER_LINEAR);
    constexpr int kRim = kReach * kOutlineFactor, kSide = kCore * kOutlineFactor;
    return fine(cv::Rect(kRim, kRim, kSide, kSide)).clone();
  });
  for (size_t k = 0; k < blocks.size(); ++k) {
    const cv::Rect core = blocks[k].core & OutlineWindow(*blocks[k].deck);
    for (int row = kOutlineFactor * core.y; row < kOutlineFactor * (core.y + core.height); ++row)
      for (int column = kOutlineFactor * core.x; column < kOutlineFactor * (core.x + core.width); ++column) {
        const int i = blocks[k].deck->index.at<int>(row, column);
        if (i < 0) continue;
        PaintedCell& cell = cells[static_cast<size_t>(i)];
        if (!cell.is_seen || cell.is_driven) continue;
        const cv::Point in_block = cv::Point(column, row) - kOutlineFactor * blocks[k].core.tl();
        cell.cell.free_belief = Corrected(cell.cell.free_belief, corrections[k].at<float>(in_block));
      }
  }
}

}  // namespace parkade
