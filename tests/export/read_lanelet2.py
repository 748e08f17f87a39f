#!/usr/bin/env python3
"""A Lanelet2 export as another program reads it, with nothing but Python's own libraries: the rules that Lanelet2
(LaneletPrimitives.md, LinestringTagging.md, lanelet2_maps/README.md) and Autoware (lanelet2_format_extension.md,
autoware_map_projection_loader) give in their documentation, and what the map's own files say.

read_lanelet2.py MAP_FOLDER EXPORT_FOLDER
"""

import collections
import json
import math
import pathlib
import sys
import xml.etree.ElementTree

POLYGONS = {"parking_lot", "obstacle"}
MILLIMETER = 0.001
CELL = 0.25  # [m] at most, by which outlines may be simpler

Way = collections.namedtuple("Way", "id nodes tags points")


def earth_from(lat, lon, height):
    """ECEF [m] of WGS84."""
    a, e2 = 6378137.0, 6.69437999014e-3
    lat, lon = math.radians(lat), math.radians(lon)
    radius = a / math.sqrt(1 - e2 * math.sin(lat) ** 2)
    ring = (radius + height) * math.cos(lat)
    return ring * math.cos(lon), ring * math.sin(lon), (radius * (1 - e2) + height) * math.sin(lat)


def plane_at(lat, lon, height):
    """The projection to east, north and up [m] from that point."""
    origin = earth_from(lat, lon, height)
    sin_lat, cos_lat = math.sin(math.radians(lat)), math.cos(math.radians(lat))
    sin_lon, cos_lon = math.sin(math.radians(lon)), math.cos(math.radians(lon))

    def project(lat, lon, height):
        x, y, z = (there - here for there, here in zip(earth_from(lat, lon, height), origin))
        outwards = cos_lon * x + sin_lon * y
        return -sin_lon * x + cos_lon * y, cos_lat * z - sin_lat * outwards, cos_lat * outwards + sin_lat * z

    return project


def read_projector(file):
    """`projector_type` and, of a LocalCartesian, its projection: Autoware takes the origin to be at altitude 0."""
    values = dict(line.split("#")[0].strip().split(":", 1) for line in file.read_text().splitlines())
    kind = values["projector_type"].strip()
    assert kind in ("Local", "LocalCartesian"), kind
    if kind == "Local":
        assert set(values) == {"projector_type"}, values
        return kind, plane_at(0, 0, 0)
    assert values["vertical_datum"].strip() == "WGS84" and float(values["altitude"]) == 0
    return kind, plane_at(float(values["latitude"]), float(values["longitude"]), 0)


def tags_of(element):
    tags = {tag.get("k"): tag.get("v") for tag in element.findall("tag")}
    assert len(tags) == len(element.findall("tag")), "a tag is there twice"
    return tags


def read_nodes(root, kind, project):
    """Positions in site [m] by id."""
    nodes = {}
    for node in root.findall("node"):
        tags = tags_of(node)
        x, y, ele = (float(tags[key]) for key in ("local_x", "local_y", "ele"))
        projected = project(float(node.get("lat")), float(node.get("lon")), ele)
        assert math.dist(projected[:2], (x, y)) < MILLIMETER, (tags, projected)
        nodes[int(node.get("id"))] = (x, y, ele if kind == "Local" else projected[2])
    assert len(nodes) == len(root.findall("node"))
    return nodes


def signed_area(ring):
    return 0.5 * sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(ring, ring[1:] + ring[:1]))


def side(a, b, c):
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def do_meet(a, b, c, d):
    """Whether two segments have a point in common."""
    for axis in (0, 1):
        if max(a[axis], b[axis]) < min(c[axis], d[axis]) or max(c[axis], d[axis]) < min(a[axis], b[axis]):
            return False
    return side(a, b, c) * side(a, b, d) <= 0 and side(c, d, a) * side(c, d, b) <= 0


def is_simple(ring):
    """No two edges meet but neighbors in their corner."""
    edges = sorted((min(a[0], b[0]), max(a[0], b[0]), i, a, b) for i, (a, b) in enumerate(zip(ring, ring[1:] + ring[:1])))
    for k, (_, right, i, a, b) in enumerate(edges):
        for left, _, j, c, d in edges[k + 1:]:
            if left > right:
                break
            if (i - j) % len(ring) not in (1, len(ring) - 1) and do_meet(a, b, c, d):
                return False
    return True


def is_within(point, ring):
    inside = False
    for a, b in zip(ring, ring[1:] + ring[:1]):
        if (a[1] > point[1]) != (b[1] > point[1]) and point[0] < a[0] + (point[1] - a[1]) * (b[0] - a[0]) / (b[1] - a[1]):
            inside = not inside
    return inside


def does_touch(line, ring):
    """What Autoware asks to find the lot of a space."""
    return is_within(line[0], ring) or any(do_meet(*line, a, b) for a, b in zip(ring, ring[1:] + ring[:1]))


def between(a, b, share):
    return tuple(from_ + share * (to - from_) for from_, to in zip(a, b))


def read_ways(root, nodes):
    ways = []
    for element in root.findall("way"):
        refs = [int(nd.get("ref")) for nd in element.findall("nd")]
        tags = tags_of(element)
        assert all(ref in nodes for ref in refs), "a node is missing"
        assert all(a != b for a, b in zip(refs, refs[1:])), "a node follows itself"
        assert tags["type"] in POLYGONS | {"parking_space", "curbstone"} and int(tags["level"]) >= 0, tags
        ways.append(Way(int(element.get("id")), refs, tags, [nodes[ref] for ref in refs]))
    ids = [*nodes, *(way.id for way in ways)]
    assert min(ids) > 0 and len(set(ids)) == len(ids), "ids are positive and no two are equal"
    assert {ref for way in ways for ref in way.nodes} == set(nodes), "a node is of no way"
    return ways


def check_tags(root, ways):
    info = root.find("MetaInfo")
    assert root.tag == "osm" and root.get("version") == "0.6"
    assert info.get("format_version")[0].isdigit() and info.get("map_version")
    for way in ways:
        kind = way.tags["type"]
        assert (way.tags.get("area") == "yes") == (kind in POLYGONS), way.tags
        if kind in POLYGONS:
            assert len(set(way.nodes)) == len(way.nodes) >= 3, "a polygon is open and has three corners"
            assert signed_area(way.points) < 0, "polygons are clockwise"
            assert is_simple(way.points), f"way {way.id} crosses itself"
        elif kind == "parking_space":
            assert len(way.nodes) == 2 and float(way.tags["width"]) > 0, way.tags
        else:
            assert len(way.nodes) >= 2 and float(way.tags["height"]) > 0, way.tags
            assert way.tags["subtype"] == ("high" if float(way.tags["height"]) > 0.06 else "low"), way.tags


def of(ways, kind, level=None):
    return [way for way in ways if way.tags["type"] == kind and level in (None, way.tags["level"])]


def check_lots(ways):
    """Each space is in one lot of its level, and none is under an obstacle; each obstacle is in a lot."""
    for space in of(ways, "parking_space"):
        level = space.tags["level"]
        lots = [lot for lot in of(ways, "parking_lot", level) if does_touch(space.points, lot.points)]
        assert len(lots) == 1, (space.tags, [lot.id for lot in lots])
        for share in (0.1, 0.3, 0.5, 0.7, 0.9):
            point = between(*space.points, share)
            assert is_within(point, lots[0].points), (space.tags, share)
            assert not any(is_within(point, way.points) for way in of(ways, "obstacle", level)), (space.tags, share)
    for obstacle in of(ways, "obstacle"):
        lots = of(ways, "parking_lot", obstacle.tags["level"])
        assert any(does_touch(obstacle.points[i:i + 2], lot.points) for lot in lots for i in range(2)), obstacle.tags


def features(file):
    return json.loads(file.read_text())["features"]


def check_slots(folder, ways):
    """Each slot of the map is there by its name, along its middle, as a rectangle of its mean size."""
    spaces = {way.tags["name"]: way for way in of(ways, "parking_space")}
    slots = features(folder / "slots.geojson")
    assert len(spaces) == len(of(ways, "parking_space")) == len(slots)
    for slot in slots:
        properties = slot["properties"]
        space, corners = spaces[properties["id"]], properties["corners_m"]
        middles = [between(a, b, 0.5) for a, b in zip(corners, corners[1:] + corners[:1])]  # the entrance's first
        across, along = (math.dist(*ends) for ends in (middles[1::2], middles[0::2]))
        begin, end = middles[0::2] if along >= across else middles[1::2]
        assert math.dist(space.points[0], begin) < 0.002 and math.dist(space.points[1], end) < 0.002, properties
        width, length = sorted((across, along))
        assert abs(float(space.tags["width"]) - width) < 0.002 and abs(width - properties["width_m"]) < 0.2, properties
        assert abs(math.dist(*space.points) - length) < 0.002 and abs(length - properties["length_m"]) < 0.2, properties
        assert int(space.tags["level"]) == properties["level"] and space.tags["subtype"] == properties["type"]


def check_kerbs(folder, ways):
    kerbs = [one["properties"] for one in features(folder / "markings.geojson") if one["properties"]["type"] == "kerb"]
    found = of(ways, "curbstone")
    assert sorted(float(way.tags["height"]) for way in found) == sorted(kerb["height_m"] for kerb in kerbs)
    for way, kerb in zip(found, kerbs):
        assert math.dist(way.points[0], kerb["points_m"][0]) < 0.002 and math.dist(way.points[-1], kerb["points_m"][-1]) < 0.002


def check_free_space(folder, ways):
    """Lots without their obstacles are the free space and the slots; what was a hole is none of it."""
    datum = json.loads((folder / "report.json").read_text())["datum"] if (folder / "report.json").exists() else None
    sheets = features(folder / "free_space.geojson")
    area = sum(-signed_area(way.points) for way in of(ways, "parking_lot")) + sum(signed_area(way.points) for way in of(ways, "obstacle"))
    free = sum(sheet["properties"]["area_m2"] for sheet in sheets)
    slots = sum(math.dist(*way.points) * float(way.tags["width"]) for way in of(ways, "parking_space"))
    assert 0.93 * free - 1 <= area <= free + 1.1 * slots + 1, (area, free, slots)
    if "frame" in json.loads((folder / "free_space.geojson").read_text()):
        def in_site(point):
            return point[:2]
    elif datum and datum["is_altitude_known"]:
        project = plane_at(datum["latitude_deg"], datum["longitude_deg"], datum["altitude"])

        def in_site(point):
            return project(point[1], point[0], point[2])[:2]
    else:
        return 0
    holes = 0
    for sheet in sheets:
        level = str(sheet["properties"]["level"])
        for ring in sheet["geometry"]["coordinates"][1:]:
            a, b = (in_site(point) for point in ring[:2])
            length = math.dist(a, b)
            point = tuple(middle + 0.01 * step for middle, step in
                          zip(between(a, b, 0.5), ((b[1] - a[1]) / length, (a[0] - b[0]) / length)))
            covered = any(is_within(point, way.points) for way in of(ways, "obstacle", level))
            near = any(distance_to_space(point, way) < CELL for way in of(ways, "parking_space", level))
            assert covered or near, f"a hole of level {level} at {point} is lost"
            holes += covered
    return holes


def distance_to_space(point, way):
    """[m] from the rectangle of a space; 0 within."""
    (x, y, _), (end_x, end_y, _) = way.points
    length = math.hypot(end_x - x, end_y - y)
    along = ((point[0] - x) * (end_x - x) + (point[1] - y) * (end_y - y)) / length
    across = abs((point[0] - x) * (end_y - y) - (point[1] - y) * (end_x - x)) / length
    return math.hypot(max(-along, along - length, 0), max(across - float(way.tags["width"]) / 2, 0))


def main():
    folder, export = map(pathlib.Path, sys.argv[1:])
    kind, project = read_projector(export / "map_projector_info.yaml")
    root = xml.etree.ElementTree.parse(export / "lanelet2_map.osm").getroot()
    nodes = read_nodes(root, kind, project)
    ways = read_ways(root, nodes)
    check_tags(root, ways)
    check_lots(ways)
    check_slots(folder, ways)
    check_kerbs(folder, ways)
    holes = check_free_space(folder, ways)
    counts = collections.Counter(way.tags["type"] for way in ways)
    print(f"{kind}: {len(nodes)} nodes, {dict(counts)}, {holes} holes kept")


if __name__ == "__main__":
    main()
