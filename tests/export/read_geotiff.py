#!/usr/bin/env python3
"""GDAL reads ortho.tif: its picture is that of ortho.png, and it lies on Earth where the datum says.

read_geotiff.py MAP_FOLDER; exits 77 where GDAL's programs are not installed.
"""

import json
import math
import pathlib
import shutil
import subprocess
import sys

LATITUDE, LONGITUDE, ALTITUDE = 48.1372, 11.5756, 520.0  # of MakeExampleMap


def output_of(*command, text=None):
    return subprocess.run(command, capture_output=True, text=True, check=True, input=text).stdout


def tangent_plane_to_wgs84(east, north):
    """By the radii of curvature of the ellipsoid at the datum's height: good to a millimeter at 50 m."""
    a, e2 = 6378137.0, 0.00669437999014
    sine = math.sin(math.radians(LATITUDE))
    prime_vertical = a / math.sqrt(1 - e2 * sine * sine)
    meridian = a * (1 - e2) / (1 - e2 * sine * sine) ** 1.5
    return (LATITUDE + math.degrees(north / (meridian + ALTITUDE)),
            LONGITUDE + math.degrees(east / ((prime_vertical + ALTITUDE) * math.cos(math.radians(LATITUDE)))))


def main():
    if not shutil.which("gdalinfo"):
        print("skipped: GDAL's programs are not installed")
        return 77
    folder = pathlib.Path(sys.argv[1])
    tiff = folder / "ortho.tif"
    info = json.loads(output_of("gdalinfo", "-json", str(tiff)))
    width, height = info["size"]
    pixel, _, _, _, _, center_y = map(float, (folder / "ortho.pgw").read_text().split())
    assert abs(info["geoTransform"][1] - pixel) < 1e-9 and abs(info["geoTransform"][5] + pixel) < 1e-9
    assert abs(info["geoTransform"][3] - (center_y + 0.5 * pixel)) < 1e-6, info["geoTransform"]
    assert [band["colorInterpretation"] for band in info["bands"]] == ["Red", "Green", "Blue", "Alpha"]

    for column, row in [(0, 0), (width, 0), (width / 2, height / 2), (width, height)]:
        east = info["geoTransform"][0] + column * pixel
        north = info["geoTransform"][3] - row * pixel
        longitude, latitude, _ = map(float, output_of(
            "gdaltransform", "-s_srs", info["coordinateSystem"]["wkt"], "-t_srs", "EPSG:4326",
            "-output_xy", text=f"{east} {north}\n").split() + ["0"])
        expected_latitude, expected_longitude = tangent_plane_to_wgs84(east, north)
        off_north = (latitude - expected_latitude) * 111200
        off_east = (longitude - expected_longitude) * 111200 * math.cos(math.radians(LATITUDE))
        assert math.hypot(off_north, off_east) < 0.005, (latitude, longitude, expected_latitude, expected_longitude)

    sums = [[band["checksum"] for band in json.loads(output_of("gdalinfo", "-json", "-checksum", str(name)))["bands"]]
            for name in (tiff, folder / "ortho.png")]
    assert sums[0] == sums[1], "the pictures differ"
    print(f"ortho.tif: {width} x {height}, {pixel} m per pixel, within 5 mm of where it belongs")
    return 0


if __name__ == "__main__":
    sys.exit(main())
