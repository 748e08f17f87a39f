#!/usr/bin/env python3
"""Checks a served map and prints its figures: check_map.py FOLDER (map.glb, map_plain.glb, ground.ply, report.json)."""

import json
import pathlib
import struct
import sys


def read_glb(path):
    """The JSON chunk of a GLB whose header and chunk lengths agree with the file."""
    data = path.read_bytes()
    magic, version, length = struct.unpack_from("<4sII", data)
    assert magic == b"glTF" and version == 2, f"{path.name} is not glTF 2.0"
    assert length == len(data), f"{path.name} is {len(data)} bytes, its header says {length}"
    chunk_length, kind = struct.unpack_from("<I4s", data, 12)
    assert kind == b"JSON", f"{path.name} does not begin with its JSON"
    return json.loads(data[20 : 20 + chunk_length]), len(data)


def main():
    folder = pathlib.Path(sys.argv[1])
    packed, packed_bytes = read_glb(folder / "map.glb")
    plain, plain_bytes = read_glb(folder / "map_plain.glb")
    assert "KHR_draco_mesh_compression" in packed.get("extensionsRequired", []), "map.glb is not Draco-compressed"
    assert not plain.get("extensionsRequired"), "map_plain.glb requires an extension"
    names = {node.get("name", "") for node in plain["nodes"]}
    assert {"site", "ground"} <= names and any(name.startswith("drive:") for name in names), f"nodes are {sorted(names)}"

    report = json.loads((folder / "report.json").read_text())
    figures = report["map"]
    assert figures["ground_area"] > 100, f"only {figures['ground_area']} m2 of ground"
    for drive in report["drives"]:
        print(f"drive {drive['name']}: {drive['length']:.1f} m in {drive['duration']:.1f} s, {drive['num_keyframes']} keyframes")
    print(f"ground: {figures['ground_area']:.0f} m2, {figures['num_triangles']} triangles")
    print(f"map.glb: {packed_bytes} bytes, map_plain.glb: {plain_bytes} bytes")
    print("stages: " + ", ".join(f"{stage['name']} {stage['seconds']:.1f} s" for stage in report["stages"]))
    for warning in report["warnings"]:
        print(f"warning: {warning}")


if __name__ == "__main__":
    try:
        main()
    except AssertionError as failure:
        sys.exit(f"not a valid map: {failure}")
