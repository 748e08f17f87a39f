#!/usr/bin/env python3
"""A drive's trajectory, covariances and KML as other programs read them: with nothing but Python's own libraries.

read_trajectories.py MAP_FOLDER
"""

import csv
import json
import math
import pathlib
import sys
import xml.etree.ElementTree

SECONDS, LEVER = 30.0, (1.2, 0.0, 0.6)  # of MakeExampleMap's drives
TURN_VARIANCES = (1e-6, 1e-6, 4e-6)
FINAL_INTERVAL, FINAL_SPAN = 0.25, (0.5, 29.5)  # of its drives' final states, whose covariances are written


def is_positive(matrix):
    """Cholesky's, on the matrix of correlations, which its six digits may leave a little off."""
    size = len(matrix)
    scale = [math.sqrt(matrix[i][i]) or 1.0 for i in range(size)]
    lower = [[0.0] * size for _ in range(size)]
    for i in range(size):
        for k in range(i + 1):
            rest = matrix[i][k] / (scale[i] * scale[k]) - sum(lower[i][j] * lower[k][j] for j in range(k))
            if i == k:
                if rest < -1e-4:
                    return False
                lower[i][i] = math.sqrt(max(rest, 1e-4))
            else:
                lower[i][k] = rest / lower[k][k]
    return True


def symmetric(upper):
    numbers = iter(upper)
    matrix = [[0.0] * 6 for _ in range(6)]
    for i in range(6):
        for k in range(i, 6):
            matrix[i][k] = matrix[k][i] = next(numbers)
    return matrix


def check_covariances(folder):
    poses = [line.split()[0] for line in (folder / "trajectory.tum").read_text().splitlines() if line[0] != "#"]
    with open(folder / "covariance.csv", newline="") as file:
        names, *rows = csv.reader(file)
    assert names[0] == "t [s]" and names[1] == "rx rx [rad^2]" and names[4] == "rx x [rad m]", names
    assert names[21] == "z z [m^2]" and names[22:] == ["site x [m]", "site y [m]", "site z [m]", "site yaw [rad]"], names
    assert len(rows) > 250 and all(len(row) == 26 for row in rows)
    assert {row[0] for row in rows} <= set(poses), "a row belongs to no pose"

    squared_lever = sum(length * length for length in LEVER)
    turned = sum(variance * (squared_lever - length * length) for variance, length in zip(TURN_VARIANCES, LEVER))
    for row in rows:
        numbers = [float(text) for text in row]
        covariance = symmetric(numbers[1:22])
        assert is_positive(covariance), row
        # Traces do not depend on frames: what the drive had walked by its nearest final state, and what its turns move
        # the IMU by.
        walked = FINAL_INTERVAL * round((numbers[0] - float(poses[0])) / FINAL_INTERVAL)
        sigma = 0.1 * min(max(walked, FINAL_SPAN[0]), FINAL_SPAN[1]) / SECONDS
        expected = sigma**2 * (1 + 1 / 4 + 1 / 16) + turned
        assert math.isclose(sum(covariance[i][i] for i in (3, 4, 5)), expected, rel_tol=1e-3), (row, expected)
        for axis, variance in enumerate(TURN_VARIANCES):
            assert math.isclose(covariance[axis][axis], variance, rel_tol=1e-4), row
        assert all(math.isfinite(number) and number > 0 for number in numbers[22:]), "the example lies on Earth"


def check_kml(folder):
    names = {"kml": "http://www.opengis.net/kml/2.2"}
    root = xml.etree.ElementTree.parse(folder / "trajectory.kml").getroot()
    text = root.find(".//kml:LineString/kml:coordinates", names).text
    points = [[float(number) for number in point.split(",")] for point in text.split()]
    feature = json.loads((folder / "trajectory.geojson").read_text())["features"][0]
    line = feature["geometry"]["coordinates"]
    assert len(points) == len(line)
    is_above_ellipsoid = "ellipsoid" in root.find(".//kml:description", names).text
    undulations = [there[2] - here[2] for here, there in zip(points, line)]
    assert max(undulations) - min(undulations) < 0.1
    assert is_above_ellipsoid == (max(map(abs, undulations)) < 1e-6), undulations[0]
    for here, there in zip(points, line):
        assert abs(here[0] - there[0]) < 1e-9 and abs(here[1] - there[1]) < 1e-9


def main():
    for drive in ("monday", "tuesday_2"):
        folder = pathlib.Path(sys.argv[1]) / drive
        check_covariances(folder)
        check_kml(folder)


if __name__ == "__main__":
    main()
