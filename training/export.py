#!/usr/bin/env python3
"""Writes a checkpoint of train.py as ONNX for OpenCV's dnn, and checks that both give the same answer.

    export.py freespace.pt freespace.onnx [--size WxH] [--mix earlier.onnx 0.3]... [--sharpen 1.35]
"""
import argparse

import cv2
import numpy as np
import torch

from network import count_parameters, fold, load, mixed

OPSET = 11  # what OpenCV 4.6 knows well
MAX_DIFFERENCE = 1e-2  # of scores


def largest_difference(network, onnx_path, size):
    width, height = size
    image = np.random.default_rng(1).integers(0, 256, (height, width, 3), np.uint8)
    image = cv2.GaussianBlur(image, (0, 0), 3)
    reader = cv2.dnn.readNetFromONNX(onnx_path)
    reader.setInput(cv2.dnn.blobFromImage(image))
    with torch.no_grad():
        ours = network(torch.from_numpy(image).permute(2, 0, 1)[None].float()).numpy()
    return float(np.abs(reader.forward() - ours).max())


def size_of(checkpoint):
    return torch.load(checkpoint, map_location="cpu")["size"]


def share_of(text):
    try:
        share = float(text)
    except ValueError:
        share = -1
    if not 0 <= share <= 1:
        raise SystemExit(f"--mix: a share is a number from 0 to 1, not {text}")
    return share


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("checkpoint")
    parser.add_argument("onnx")
    parser.add_argument("--size", help="of the input: WxH, multiples of 32; default: that of the training")
    parser.add_argument("--mix", nargs=2, action="append", default=[], metavar=("FILE", "SHARE"),
                        help="earlier weights that these were trained from, and the share of them to keep")
    parser.add_argument("--sharpen", type=float, default=1, help="factor of the scores: maps count a pixel fully from log-odds of 4")
    arguments = parser.parse_args()
    width, height = (int(number) for number in arguments.size.split("x")) if arguments.size else size_of(arguments.checkpoint)
    if width % 32 or height % 32:
        raise SystemExit("the size must be in multiples of 32")

    network = load(arguments.checkpoint).eval()
    if arguments.mix:
        network = mixed(fold(network), [(fold(load(path)), share_of(text)) for path, text in arguments.mix])
    with torch.no_grad():
        network.head.weight *= arguments.sharpen
        network.head.bias *= arguments.sharpen
    torch.onnx.export(network, torch.zeros(1, 3, height, width), arguments.onnx, opset_version=OPSET,
                      input_names=["image"], output_names=["scores"])
    difference = largest_difference(network, arguments.onnx, (width, height))
    print(f"{count_parameters(network)} parameters, {width}x{height}, largest difference to OpenCV {difference:.1e}")
    if difference > MAX_DIFFERENCE:
        raise SystemExit("OpenCV reads the network differently")


if __name__ == "__main__":
    main()
