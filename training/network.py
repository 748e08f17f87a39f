"""The free-space network: an encoder-decoder with skip connections, small enough for one processor core:
depthwise-separable convolutions where pictures are large or channels many, a few dense ones in between. Input: N x 3 x
H x W, BGR, 0..255, H and W multiples of 32. Output: N x 9 x H/2 x W/2, scores of the classes (classes.py) before their
softmax.
"""
import torch
from torch import nn
from torch.nn import functional
from torch.nn.utils.fusion import fuse_conv_bn_eval

from classes import NAMES, NUM_FREE

PIXEL_SCALE = 1 / 128  # no offset: black stays zero, which is also what convolutions pad with


def conv(inputs, outputs, size=3, stride=1, groups=1):
    """Convolution, batch normalization (folded on export), ReLU."""
    return nn.Sequential(
        nn.Conv2d(inputs, outputs, size, stride, size // 2, groups=groups, bias=False),
        nn.BatchNorm2d(outputs),
        nn.ReLU(inplace=True),
    )


def separable(inputs, outputs, size=3, stride=1):
    """Depthwise, then pointwise convolution."""
    return nn.Sequential(conv(inputs, inputs, size, stride, groups=inputs), conv(inputs, outputs, 1))


def wide(channels, size):
    """What a depthwise convolution of `size` (odd) reaches, as several of 3 x 3, for which OpenCV has fast code."""
    return nn.Sequential(*(nn.Sequential(nn.Conv2d(channels, channels, 3, padding=1, groups=channels, bias=False),
                                         nn.BatchNorm2d(channels), nn.Identity()) for _ in range(size // 2)),
                         nn.ReLU(inplace=True))


def wide_separable(channels, size):
    """Wide depthwise, then pointwise convolution."""
    return nn.Sequential(wide(channels, size), conv(channels, channels, 1))


class Residual(nn.Module):
    """y = x + block(x)."""

    def __init__(self, block):
        super().__init__()
        self.block = block

    def forward(self, x):
        return x + self.block(x)


class Decoder(nn.Module):
    """Doubles the resolution, adds what the encoder knew there and mixes both."""

    def __init__(self, deep, skip, *mixes):
        super().__init__()
        self.reduce = conv(deep, skip, 1)
        self.mix = nn.Sequential(*(Residual(mix) for mix in mixes))

    def forward(self, deep, skip):
        up = functional.interpolate(self.reduce(deep), scale_factor=2, mode="bilinear", align_corners=False)
        return self.mix(up + skip)


class FreespaceNetwork(nn.Module):
    def __init__(self, widths=(12, 24, 48, 96, 192)):
        super().__init__()
        half, quarter, eighth, sixteenth, deepest = widths
        # Hardly more than colors at half of the resolution: it is for edges, and costs the most per channel.
        self.at_half = conv(3, half, 3, 2)
        self.at_quarter = nn.Sequential(separable(half, quarter, 3, 2), Residual(conv(quarter, quarter)))
        self.at_eighth = nn.Sequential(separable(quarter, eighth, 3, 2), Residual(conv(eighth, eighth)),
                                       Residual(conv(eighth, eighth)))
        self.at_sixteenth = nn.Sequential(separable(eighth, sixteenth, 3, 2), Residual(conv(sixteenth, sixteenth)),
                                          Residual(wide_separable(sixteenth, 5)),
                                          *(Residual(conv(sixteenth, sixteenth)) for _ in range(2)))
        # Wide reach: whether gray is road depends on where in the picture it is.
        self.at_deepest = nn.Sequential(separable(sixteenth, deepest, 5, 2),
                                        *(Residual(wide_separable(deepest, 7)) for _ in range(4)))
        self.to_sixteenth = Decoder(deepest, sixteenth, separable(sixteenth, sixteenth))
        # Where the outline runs is decided between these two: dense once more, above what the deeper ones say.
        self.to_eighth = Decoder(sixteenth, eighth, separable(eighth, eighth), conv(eighth, eighth))
        self.to_quarter = Decoder(eighth, quarter, separable(quarter, quarter), conv(quarter, quarter))
        self.to_half = Decoder(quarter, half, separable(half, half))
        self.head = nn.Conv2d(half, len(NAMES), 1)

    def forward(self, picture):
        half = self.at_half(picture * PIXEL_SCALE)
        quarter = self.at_quarter(half)
        eighth = self.at_eighth(quarter)
        sixteenth = self.at_sixteenth(eighth)
        deep = self.to_sixteenth(self.at_deepest(sixteenth), sixteenth)
        return self.head(self.to_half(self.to_quarter(self.to_eighth(deep, eighth), quarter), half))


def log_odds_of(scores):
    """N x H x W: of "drivable", of N x 9 x H x W scores."""
    return torch.logsumexp(scores[:, :NUM_FREE], 1) - torch.logsumexp(scores[:, NUM_FREE:], 1)


def with_classes(state):
    """The weights of a network that gave one channel, the log-odds of "drivable", as those of one that gives the same by the
    scores of all classes."""
    weight, bias = state["head.weight"], state["head.bias"]
    if weight.shape[0] != 1:
        return state
    sign = torch.where(torch.arange(len(NAMES)) < NUM_FREE, 0.5, -0.5)
    count = torch.where(torch.arange(len(NAMES)) < NUM_FREE, NUM_FREE, len(NAMES) - NUM_FREE)
    noise = 0.02 * torch.randn(len(NAMES), *weight.shape[1:])  # else they would stay alike
    return {**state, "head.weight": sign.view(-1, 1, 1, 1) * weight + noise, "head.bias": sign * bias - torch.log(count.float())}


def fold(network):
    """The same network with batch normalization folded into the convolutions: nearly twice as fast to train further."""
    network.eval()
    for block in network.modules():
        if isinstance(block, nn.Sequential) and len(block) == 3 and isinstance(block[1], nn.BatchNorm2d):
            block[0], block[1] = fuse_conv_bn_eval(block[0], block[1]), nn.Identity()
    return network


def mixed(network, others):
    """`network` with a share of the weights of `others`, pairs of networks and shares, that it was trained from: what the
    training gained on its places stays for the most part, what it lost on others comes back."""
    own_share = 1 - sum(share for _, share in others)
    states = [(network.state_dict(), own_share)] + [(other.state_dict(), share) for other, share in others]
    network.load_state_dict({name: sum(share * state[name] for state, share in states) for name in states[0][0]})
    return network


def load(path):
    """What train.py has saved, folded or not, or export.py has written of a folded one (FILE.onnx)."""
    state = read_onnx(path) if str(path).endswith(".onnx") else torch.load(path, map_location="cpu")["network"]
    network = FreespaceNetwork()
    if not any(name.endswith("running_mean") for name in state):
        network = fold(network)
    network.load_state_dict(with_classes(state))
    return network


def read_onnx(path):
    """The weights of an ONNX file by their names, which those of a folded network keep."""
    import onnx
    from onnx import numpy_helper

    return {weights.name: torch.from_numpy(numpy_helper.to_array(weights).copy())
            for weights in onnx.load(str(path)).graph.initializer if "." in weights.name}


def in_bfloat16(enabled, device="cpu"):
    """Within it, layers calculate in bfloat16 while weights stay float32: three to six times as fast on processors that
    have instructions for it (AVX512-BF16, AMX) and on graphics cards, slower on others. Pictures in the order of channels_last
    gain most."""
    return torch.autocast(device, dtype=torch.bfloat16, enabled=enabled)


def count_parameters(network):
    return sum(parameter.numel() for parameter in network.parameters())
