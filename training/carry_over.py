#!/usr/bin/env python3
"""Carries weights of the network as it was until stage eleven over to its present shape; see README.md.

    carry_over.py EARLIER.onnx grown.pt

That network had depthwise convolutions of 5 x 5 and 7 x 7 where there are several of 3 x 3 now, and fewer dense blocks.
"""
import argparse
import re

import torch
from torch.nn import functional

from network import FreespaceNetwork, fold, read_onnx

WIDE = {"at_sixteenth.2": 2, **{f"at_deepest.{i}": 3 for i in range(1, 5)}}  # blocks and how many of 3 x 3 they have now
TRIALS, STEPS, RATE = 4, 1200, 0.03
SMALL = 0.3  # of the usual spread of random weights: a new block begins as hardly more than what it is added to


def composed(kernels):
    """The one depthwise kernel that does what these do one after the other."""
    whole = kernels[0].transpose(0, 1)
    for kernel in kernels[1:]:
        whole = functional.conv2d(whole, kernel.flip(2, 3), padding=2, groups=kernel.shape[0])
    return whole.transpose(0, 1)


def one_trial(wanted, count):
    """`count` kernels of 3 x 3 whose composition is near `wanted` (channels x 1 x size x size), and the squared rest."""
    kernels = [0.15 * torch.randn(wanted.shape[0], 1, 3, 3) for _ in range(count)]
    for kernel in kernels:
        kernel[:, :, 1, 1] += 1
        kernel.requires_grad_()
    optimizer = torch.optim.Adam(kernels, lr=RATE)
    for step in range(STEPS):
        optimizer.param_groups[0]["lr"] = RATE * (1 - step / STEPS) + 1e-4
        rest = (composed(kernels) - wanted).square().flatten(1).sum(1)
        optimizer.zero_grad()
        rest.sum().backward()
        optimizer.step()
    return torch.stack([kernel.detach() for kernel in kernels]), rest.detach()


def split(wide, count):
    """The best of some trials for each channel, all its kernels of the same norm."""
    norms = wide.flatten(1).norm(dim=1)[:, None, None, None]
    kernels, rest = one_trial(wide / norms, count)
    for _ in range(TRIALS - 1):
        others, other_rest = one_trial(wide / norms, count)
        better = other_rest < rest
        kernels[:, better], rest[better] = others[:, better], other_rest[better]
    print(f"{count} of 3 x 3 for {wide.shape[-1]} x {wide.shape[-1]}: {100 * rest.mean():.0f} % of the squares remain")
    lengths = kernels.flatten(2).norm(dim=2)[..., None, None, None]
    return kernels / lengths * (norms * lengths.prod(0)) ** (1 / count)


def carry_over(earlier):
    """The folded network of the present shape with the weights that it shares with `earlier`."""
    network = fold(FreespaceNetwork())
    state = network.state_dict()
    for name, value in state.items():
        source = re.sub(r"\.mix\.0\.", ".mix.", name)
        if source in earlier and earlier[source].shape == value.shape:
            state[name] = earlier[source]
        elif name.endswith(".bias"):
            state[name] = 1e-4 * torch.randn_like(value)  # not all alike: the exporter would share them
        else:
            state[name] = SMALL * (2 / value[0].numel()) ** 0.5 * torch.randn_like(value)
    for block, count in WIDE.items():
        for i, kernel in enumerate(split(earlier[f"{block}.block.0.0.weight"], count)):
            state[f"{block}.block.0.{i}.0.weight"] = kernel
        state[f"{block}.block.0.{count - 1}.0.bias"] = earlier[f"{block}.block.0.0.bias"]
    network.load_state_dict(state)
    return network


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("earlier")
    parser.add_argument("checkpoint")
    arguments = parser.parse_args()
    torch.manual_seed(1)
    network = carry_over(read_onnx(arguments.earlier))
    torch.save({"network": network.state_dict(), "size": (640, 384)}, arguments.checkpoint)


if __name__ == "__main__":
    main()
