#!/usr/bin/env python3
"""Writes a checkpoint of train_outlines.py as ONNX for OpenCV's dnn, and checks that both give the same answer.

    export_outlines.py outlines.pt outlines.onnx [--mix earlier.onnx]
"""
import argparse

import cv2
import numpy as np
import torch

from network import fold, mixed
from outline_network import FEATURES, load

OPSET = 11  # what OpenCV 4.6 knows well
SIZES = ((320, 320), (96, 208))  # rows and columns: the file is for all multiples of 4
MAX_DIFFERENCE = 1e-3  # of log-odds


def largest_difference(network, onnx_path):
    differences, reader = [], cv2.dnn.readNetFromONNX(onnx_path)
    for size in SIZES:
        features = np.random.default_rng(1).random((1, FEATURES, *size), np.float32)
        reader.setInput(features)
        with torch.no_grad():
            ours = network(torch.from_numpy(features)).numpy()
        differences.append(float(np.abs(reader.forward() - ours).max()))
    return max(differences)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("checkpoint")
    parser.add_argument("onnx")
    parser.add_argument("--doubt", type=float, default=0.0,
                        help="log-odds that every correction loses: less false free space for more ground missed")
    parser.add_argument("--mix", help="earlier weights that these were trained from: the mean of both is written")
    arguments = parser.parse_args()
    network = fold(load(arguments.checkpoint))
    if arguments.mix:
        network = mixed(network, [(fold(load(arguments.mix)), 0.5)])
    with torch.no_grad():
        network.head.bias -= arguments.doubt
    torch.onnx.export(network, torch.zeros(1, FEATURES, *SIZES[0]), arguments.onnx, opset_version=OPSET,
                      input_names=["ground"], output_names=["correction"])
    difference = largest_difference(network, arguments.onnx)
    count = sum(parameter.numel() for parameter in network.parameters())
    print(f"{count} parameters, largest difference to OpenCV {difference:.1e}")
    if difference > MAX_DIFFERENCE:
        raise SystemExit("OpenCV reads the network differently")


if __name__ == "__main__":
    main()
