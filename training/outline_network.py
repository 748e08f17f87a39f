"""The network that corrects outlines: looks at painted ground from above (mapping/surface/outline_features.h), a pixel per 0.1 m.
Input: N x 15 x H x W, H and W multiples of 4. Output: N x 1 x H x W, what is added to the log-odds of "drivable".
A pixel depends on at most 31 others in each direction, so that the ground can be painted square by square.
"""
import torch
from torch import nn
from torch.nn import functional

from network import Residual, conv, fold, read_onnx

FEATURES = 15
SEEN, LOG_ODDS, FREE, OCCUPIED, COLORS = 0, 1, 2, 3, slice(9, 12)
RAISED, MEASURED, CERTAINTY = 12, 13, 14  # above the road, 0.1 m
LOG_ODDS_UNIT = 8  # of feature LOG_ODDS
MAX_CORRECTION = 12  # a step outweighs whatever images say: log-odds of 9.2 at most


class Decoder(nn.Module):
    """Doubles the resolution and adds what the encoder knew there."""

    def __init__(self, deep, skip):
        super().__init__()
        self.reduce = conv(deep, skip, 1)
        self.mix = Residual(conv(skip, skip))

    def forward(self, deep, skip):
        up = functional.interpolate(self.reduce(deep), scale_factor=2, mode="bilinear", align_corners=False)
        return self.mix(up + skip)


class OutlineNetwork(nn.Module):
    def __init__(self, widths=(12, 24, 48), depth=4):
        super().__init__()
        full, half, quarter = widths
        self.at_full = conv(FEATURES, full)
        self.at_half = nn.Sequential(conv(full, half, 3, 2), Residual(conv(half, half)))
        self.at_quarter = nn.Sequential(conv(half, quarter, 3, 2), *(Residual(conv(quarter, quarter)) for _ in range(depth)))
        self.to_half = Decoder(quarter, half)
        self.to_full = Decoder(half, full)
        self.head = nn.Conv2d(full, 1, 1)

    def forward(self, features):
        full = self.at_full(features)
        half = self.at_half(full)
        deep = self.to_half(self.at_quarter(half), half)
        return MAX_CORRECTION * torch.tanh(self.head(self.to_full(deep, full)) / MAX_CORRECTION)


def with_correction(features, correction):
    """Log-odds of the input with the correction: N x 1 x H x W."""
    return LOG_ODDS_UNIT * features[:, LOG_ODDS : LOG_ODDS + 1] + correction


def corrected(network, features):
    return with_correction(features, network(features))


def load(path):
    """What train_outlines.py has saved, or export_outlines.py has written (FILE.onnx), with batch normalization folded."""
    state = read_onnx(path) if str(path).endswith(".onnx") else torch.load(path, map_location="cpu")["network"]
    network = OutlineNetwork()
    first = state["at_full.0.weight"]
    state["at_full.0.weight"] = functional.pad(first, (0, 0, 0, 0, 0, FEATURES - first.shape[1]))  # of fewer features
    if not any(name.endswith("running_mean") for name in state):
        network = fold(network)
    network.load_state_dict(state)
    return network
