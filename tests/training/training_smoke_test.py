#!/usr/bin/env python3
"""Weights of pixels; level views; bands of paint; fields; kerbs; own cars; two steps of training on made-up pictures and one more with batch normalization folded,
exported, read by OpenCV and trained on from there; kernels carried over; also of the network of outlines, on made-up ground. Skipped (77) without PyTorch.

training_smoke_test.py TRAINING_FOLDER
"""
import json
import pathlib
import subprocess
import sys
import tempfile

try:
    import cv2
    import numpy as np
    import onnx  # noqa: F401
    import torch
    import yaml  # noqa: F401
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(77)


def write_picture(folder, name, rng):
    """A bright sky over a dark road."""
    classes = np.zeros((90, 120), np.uint8)
    classes[50:] = 3
    image = np.where(classes[..., None] == 3, 70, 200) + rng.normal(0, 5, (90, 120, 3))
    (folder / "images").mkdir(parents=True, exist_ok=True)
    (folder / "labels").mkdir(exist_ok=True)
    cv2.imwrite(str(folder / "images" / (name + ".jpg")), image.clip(0, 255).astype(np.uint8))
    cv2.imwrite(str(folder / "labels" / (name + ".png")), classes)


def check_weights(training):
    """Of a fisheye 1 m above the ground that looks ahead: the ground of its pixels grows with the cube of the distance."""
    sys.path.insert(0, str(training))
    sys.dont_write_bytecode = True
    from ground_area import weigh_pixels

    focal, size = 200.0, (641, 401)
    matrix = np.array([[focal, 0, 320], [0, focal, 200], [0, 0, 1.0]])
    body_from_camera = np.array([[0, 0, 1, 0], [-1, 0, 0, 0], [0, -1, 0, 1], [0, 0, 0, 1.0]])
    weights = weigh_pixels(size, matrix, np.zeros(4), body_from_camera)
    assert weights.shape == (401, 641) and np.isfinite(weights).all() and weights.min() == 1
    at = lambda distance: weights[round(200 + focal * np.arctan2(1.0, distance)), 320]
    for near, far in ((4.0, 5.0), (4.0, 6.0), (5.0, 7.0)):
        expected = ((far**2 + 1) / (near**2 + 1)) ** 0.75
        assert abs(at(far) / at(near) / expected - 1) < 0.1, (near, far, at(far) / at(near), expected)
    assert weights[300, 320] == 1 and weights[100, 320] == 1  # at the car; sky


def check_level_views():
    """Of a fisheye that looks down and to the left: what lies lower than -5 degrees lies below one row of the view, whether
    the camera is taken as it is or as another one."""
    import level_view
    import pictures
    import views

    columns, rows = np.meshgrid(np.arange(0.0, 832, 50), np.arange(0.0, 288, 20))
    assert np.allclose(level_view.pixel_of(*level_view.angles_of(columns, rows)), (columns, rows))
    # As PixelOf of mapping/networks/level_view.h has it, 3 m ahead, 3 m to the left and 1 m down.
    assert np.allclose(level_view.pixel_of(-np.pi / 4, -np.arctan2(1, np.hypot(3, 3))), (219.848, 140.948), atol=0.01)

    ahead = np.array([[0, 0, 1.0], [-1, 0, 0], [0, -1, 0]])
    turned = cv2.Rodrigues(np.array([0, 0, 0.7]))[0] @ cv2.Rodrigues(np.array([0, 0.5, 0]))[0] @ ahead
    matrix, coefficients = np.array([[198.0, 0, 320], [0, 198, 200], [0, 0, 1]]), np.array([0.01, -0.002, 0, 0])
    body_from_camera = np.block([[turned, np.array([[1.0], [2], [0.9]])], [np.zeros((1, 3)), np.ones((1, 1))]])
    pixels = np.stack(np.meshgrid(np.arange(640), np.arange(400)), -1).reshape(-1, 1, 2).astype(float)
    rays = cv2.convertPointsToHomogeneous(cv2.fisheye.undistortPoints(pixels, matrix, coefficients))[:, 0] @ turned.T
    is_low = rays[:, 2] < -np.tan(np.radians(5)) * np.hypot(rays[:, 0], rays[:, 1])
    label = np.where(is_low, 255, 0).reshape(400, 640).astype(np.uint8)
    classes = np.where(is_low, 0, 7).reshape(400, 640).astype(np.uint8)
    picture = pictures.Picture("a", cv2.cvtColor(label, cv2.COLOR_GRAY2BGR), label, classes, True,
                               camera=((640, 400), matrix, coefficients, body_from_camera))
    middle = level_view.as_seen_level(picture).label[:200, 200:632]
    row = level_view.pixel_of(0, np.radians(-5))[1]
    assert (middle[: int(row) - 1] == 0).all() and (middle[int(row) + 3 :] == 255).all()
    for seed in range(5):
        _, label, classes, _ = views.LevelView().change_geometry(np.random.default_rng(seed), picture)
        is_known = classes != 255
        assert is_known.mean() > 0.3 and ((classes == 0) == (label == 255))[is_known].mean() > 0.99
        edges = (label[:200, 300:532] == 255).argmax(0)
        assert edges.min() > row - 40 and edges.max() < row + 40 and np.ptp(edges) < 25, (seed, edges)
        _, label, _, _ = views.LevelView().show_as_mapped(np.random.default_rng(seed), picture)
        edges = (label[:200, 200:632] == 255).argmax(0)
        assert abs(edges - row).max() < 4, (seed, edges)


def check_bands_on_the_ground():
    """Bands are seen on the ground alone; across them, pixels of the share that is covered add up to the width."""
    import level_view
    import stripes

    _, elevation = level_view.angles_of(0, np.arange(level_view.SIZE[1]))
    covered = 0
    for seed in range(20):
        band = stripes.band_in_view(np.random.default_rng(seed))
        assert band.shape == (288, 832, 1) and np.isfinite(band).all() and band.min() >= 0 and band.max() <= 1
        assert (band[elevation > np.radians(-1)] == 0).all()
        covered += band.max() > 0.5
    assert covered > 10, covered
    for pixel in (0.01, 0.1, 0.5):  # of ground; the band is 0.3 wide
        across = np.float32(np.abs(np.arange(-50, 50) + 0.3)) * np.float32(pixel) * np.ones((3, 1), np.float32)
        width = pixel * stripes.share_below(across, 0.15)[1].sum()
        assert abs(width - 0.3) < 0.1 * max(pixel, 0.3), (pixel, width)


def check_fields():
    """Fields change the ground alone, and more of it than their lines; of a pixel that a line cuts both sides have their share."""
    import level_view
    import stripes

    _, elevation = level_view.angles_of(0, np.arange(level_view.SIZE[1]))
    floor, areas = np.full((288, 832, 3), 90, np.float32), []
    for seed in range(20):
        change = np.abs(stripes.paint_field(np.random.default_rng(seed), floor) - floor).max(2)
        assert np.isfinite(change).all() and (change[elevation > np.radians(-1)] < 1e-3).all()
        areas.append((change > 2).mean())
    assert np.median(areas) > 0.1, areas
    for pixel in (0.01, 0.5):
        beyond = np.float32(np.arange(-50, 50) + 0.3) * np.float32(pixel) * np.ones((3, 1), np.float32)
        assert abs(stripes.share_behind(beyond)[1].sum() - 50.2) < 0.01, pixel


def check_kerbs():
    """A kerb is not drivable, and the floor on both its sides stays so."""
    from kerbs import add_kerb

    image, rng, changes = np.full((192, 320, 3), 90, np.uint8), np.random.default_rng(3), []
    for _ in range(20):
        label = np.full((192, 320), 255, np.uint8)
        painted = add_kerb(rng, image, label)
        assert 0.001 < (label == 0).mean() < 0.2, (label == 0).mean()
        change = np.abs(painted.astype(float) - 90).mean(2)
        changes.append((change[label == 0].mean(), change[label == 255].mean()))
    of_kerbs, of_floor = np.mean(changes, 0)
    assert of_kerbs > 2 * of_floor, (of_kerbs, of_floor)


def check_thin_car():
    """A body of nine rows, the fewest that are painted, with dirt or without."""
    import own_car

    edge_of_body, changed = own_car.edge_of_body, 0
    own_car.edge_of_body = lambda rng, size: np.full(size[0], size[1] - 7.5)
    for seed in range(60):
        image, label = np.full((48, 80, 3), 90, np.uint8), np.full((48, 80), 255, np.uint8)
        changed += (own_car.add_own_car(np.random.default_rng(seed), image, label)[-5:] != 90).any()
        assert (label[:40] == 255).all() and (label[-5:] == 0).all(), seed
    own_car.edge_of_body = edge_of_body
    assert changed > 50, changed


def check_islands():
    """On a level view of bare ground: an island cannot be driven on and is of what islands are made of, stones toward the car;
    the frame of one is paint, and all within stays drivable."""
    import classes as surfaces
    import islands
    import level_view
    from pictures import DRIVABLE

    rng = np.random.default_rng(2)
    shape = level_view.SIZE[::-1]
    num_islands = num_frames = 0
    for _ in range(60):
        label = np.full(shape, DRIVABLE, np.uint8)
        label[:100] = 0
        classes = np.where(label == DRIVABLE, surfaces.DRIVABLE, surfaces.STRUCTURE).astype(np.uint8)
        before, was = np.full((*shape, 3), 90, np.uint8), classes.copy()
        image = islands.add_island(rng, before, label, classes)
        assert (image[:95] == 90).all() and (classes[:100] == surfaces.STRUCTURE).all()
        changed = classes != was
        assert (label[changed] == DRIVABLE).all() or (label[changed] == 0).all()
        if (label[100:] == 0).any():
            num_islands += 1
            inside = np.unique(classes[label == 0][classes[label == 0] != surfaces.STRUCTURE])
            assert set(inside) <= {surfaces.VEGETATION, surfaces.PAVEMENT, surfaces.KERB} and surfaces.KERB in inside, inside
            below = np.argmax(label[::-1] == 0, 0)  # rows from the picture's lower rim to the island
            columns = np.flatnonzero((below > 0) & (label[100:] == 0).any(0))
            feet = classes[shape[0] - 1 - below[columns], columns]
            assert (feet == surfaces.KERB).mean() > 0.8, (feet == surfaces.KERB).mean()
        elif changed.any():
            num_frames += 1
            assert set(np.unique(classes[changed])) == {surfaces.MARKING}
    assert num_islands > 10 and num_frames > 10, (num_islands, num_frames)


def check_recycling():
    """Pictures whose gray is their label: bent ones stay so, whatever their size; a pool returns what it was given last."""
    import classes as surfaces
    import recycling
    from pictures import DRIVABLE, UNKNOWN

    rng = np.random.default_rng(3)
    blocks = rng.integers(0, 2, (6, 6, 10), np.uint8)
    label = np.kron(blocks, np.ones((16, 16), np.uint8)) * DRIVABLE
    batch = (np.repeat(label[..., None], 3, -1), label, label[:, ::2, ::2], np.full(label.shape, 1.5, np.float32))
    pool = recycling.Pool("cpu", 4)
    pool.put(*batch)
    assert pool.count == 6
    torch.manual_seed(1)
    for spread in ((0.06, 0.18, 0.18, 0.12, 0.1), (0, 0.06, 0, 0.1, 0.008)):
        bent = recycling.bend(*pool.draw(40), spread)
        for size in ((160, 96), (80, 48)):
            images, labels, classes, weights = recycling.resized(*bent, size)
            assert images.shape == (40, 3, *size[::-1]) and classes.shape == (40, size[1] // 2, size[0] // 2)
            known = labels != UNKNOWN
            agree = ((images[:, 0] > 127) == (labels == DRIVABLE))[known].float().mean()
            assert known.float().mean() > 0.6 and agree > 0.95, (known.float().mean(), agree)
            of_pixels = labels[:, ::2, ::2]
            both = (of_pixels != UNKNOWN) & (classes != surfaces.UNKNOWN)
            assert (of_pixels == classes)[both].float().mean() > 0.9
            assert (weights[labels == UNKNOWN] == 0).all() and (weights[known] - 1.5).abs().mean() < 0.05
    varied = recycling.vary(*pool.draw(8), (0.06, 0.18, 0.18, 0.12, 0.1))
    assert varied[0].min() >= 0 and varied[0].max() <= 255 and torch.isfinite(varied[0]).all()


def check_classes():
    """Of pictures that are changed, what is drivable keeps a drivable class, and what is painted over has its own; labels that
    leave classes open cost nothing where one of them is found; weights of one channel say the same by all classes."""
    import augment
    import classes as surfaces
    import pictures
    from network import FreespaceNetwork, log_odds_of, with_classes
    from train import class_loss_of
    from views import CameraView

    rng = np.random.default_rng(4)
    of_pixels = np.full((384, 640), surfaces.STRUCTURE, np.uint8)
    of_pixels[200:], of_pixels[200:, 300:340], of_pixels[200:230] = surfaces.DRIVABLE, surfaces.MARKING, surfaces.PAVEMENT
    image = np.uint8(40 + 20 * of_pixels[..., None] + rng.normal(0, 4, (384, 640, 3)))
    picture = pictures.Picture("lot", image, pictures.label_of(of_pixels), of_pixels, True)
    found = set()
    for _ in range(40):
        _, label, changed, _ = augment.augment(rng, picture, CameraView((320, 192)))
        known = changed != surfaces.UNKNOWN
        assert ((pictures.label_of(changed) == label) | (label == pictures.UNKNOWN))[known].all()
        found |= set(np.unique(changed).tolist())
    assert found >= {surfaces.DRIVABLE, surfaces.ROAD, surfaces.PAVEMENT, surfaces.KERB, surfaces.STRUCTURE, surfaces.OWN_CAR}, found

    def loss(number, label):
        scores = torch.full((1, 9, 8, 8), -20.0)
        scores[:, number] = 20
        return class_loss_of(scores, torch.full((1, 8, 8), label, dtype=torch.uint8)).item()

    assert max(loss(surfaces.MARKING, surfaces.ROAD), loss(surfaces.KERB, surfaces.PAVED), loss(2, surfaces.UNKNOWN)) < 0.31
    assert loss(2, 2) < 0.02 and min(loss(surfaces.PAVEMENT, surfaces.ROAD), loss(0, 1), loss(surfaces.OWN_CAR, 5)) > 5

    torch.manual_seed(3)
    network, features = FreespaceNetwork(), torch.randn(1, 12, 16, 16)
    one = torch.nn.Conv2d(12, 1, 1)
    state = with_classes({**network.state_dict(), "head.weight": one.weight.data, "head.bias": one.bias.data})
    network.load_state_dict(state)
    difference = (log_odds_of(network.head(features)) - one(features)[:, 0]).abs()
    assert difference.max() < 0.3, difference.max()

    confusion = surfaces.Confusion()
    confusion.add(np.array([[9, 9, 2, 255]], np.uint8), np.array([[1, 2, 4, 0]], np.uint8))
    assert np.allclose(confusion.ious()[:2], (0.5, 0.5)) and np.isnan(confusion.ious()[2:]).all()
    scores = np.full((9, 1, 1), -5.0, np.float32)
    scores[[0, 1], 0, 0], scores[5, 0, 0] = 1.0, 1.5  # two that are one weigh more
    assert surfaces.merged_class_of(scores)[0, 0] == surfaces.DRIVABLE


def check_fold():
    """Folding changes nothing of what the network says."""
    from network import FreespaceNetwork, fold

    torch.manual_seed(1)
    network, picture = FreespaceNetwork(), 255 * torch.rand(2, 3, 64, 96)
    network.train()(picture)  # means and variances that are not 0 and 1
    before = network.eval()(picture)
    after = fold(network)(picture)
    assert not any(isinstance(part, torch.nn.BatchNorm2d) for part in network.modules())
    assert torch.allclose(before, after, atol=1e-3 * float(before.abs().max())), (before - after).abs().max()


def check_composed():
    """Small depthwise kernels one after the other are the one that carry_over.py makes of them, but at the rim."""
    from carry_over import composed

    torch.manual_seed(2)
    kernels, picture = [torch.randn(5, 1, 3, 3) for _ in range(3)], torch.rand(1, 5, 20, 24)
    after = picture
    for kernel in kernels:
        after = torch.nn.functional.conv2d(after, kernel, padding=1, groups=5)
    at_once = torch.nn.functional.conv2d(picture, composed(kernels), padding=3, groups=5)
    assert torch.allclose(after[..., 3:-3, 3:-3], at_once[..., 3:-3, 3:-3], atol=1e-3), (after - at_once).abs().max()


def write_raster(name, rng):
    """Ground with a box on it: as parkade-outline-rasters writes them."""
    truth = np.ones((180, 200), np.uint8)
    truth[60:100, 70:90], truth[:, 190:], truth[:10] = 0, 2, 3
    features = rng.random((15, *truth.shape)).astype(np.float32)
    features[0] = truth != 3
    features[1] = np.where(truth == 0, -0.3, 0.3)
    features.tofile(name.with_suffix(".features"))
    truth.tofile(name.with_suffix(".truth"))
    name.with_suffix(".json").write_text(json.dumps({"channels": 15, "rows": truth.shape[0], "columns": truth.shape[1]}))


def check_outlines(folder):
    """What is near a box weighs more, what is unknown nothing; a perfect outline is one, a shrunken one is not."""
    import outline_rasters as rasters
    from outline_network import OutlineNetwork, corrected

    write_raster(folder / "ground_0", np.random.default_rng(2))
    ((name, features, truth),) = rasters.load_rasters(folder)
    assert name == "ground_0" and features.shape == (15, 180, 200)
    weights = rasters.weights_of(features, truth)
    assert weights[5].max() == 0 and weights[:, 195].max() == 0 and weights[55, 80] > weights[150, 20] > 0
    perfect = rasters.compare(features, truth, np.where(truth == 0, -1, 1))
    assert perfect["boundary"] == 1 and perfect["missed"] == 0 and perfect["false"] == 0, perfect
    smaller = rasters.compare(features, truth, np.where(cv2.dilate((truth == 0).astype(np.uint8), np.ones((9, 9))), -1, 1))
    assert 0.5 < smaller["boundary"] < 0.9 and smaller["missed"] > 0 and smaller["false"] == 0, smaller
    for seed in range(10):
        square = rasters.cut_square(np.random.default_rng(seed), features, truth, 96, share_turned=seed % 2)
        changed, label = rasters.augment(np.random.default_rng(seed), *square)
        assert sorted(label.ravel()) == sorted(square[1].ravel()) and np.isfinite(changed).all()
        # Turned or not, the box lies where it is labeled, but for cells along its outline and errors that were added.
        assert (changed[13][changed[14] == 0] == 0).all() and abs(changed[12:14]).max() <= 2
        counts = (changed[0] > 0.9) & (label != 3)
        middle = np.mean([changed[1][counts & (label == kind)].mean() for kind in (0, 1)])  # a network may be unsure of all
        assert ((changed[1] < middle) == (label == 0))[counts].mean() > 0.93, seed
    # What lies further than the reach that the program relies on has no say.
    network = OutlineNetwork().eval()
    ground = torch.rand(1, 15, 96, 96)
    other = ground.clone()
    other[..., 64:] = 0
    with torch.no_grad():
        difference = (corrected(network, ground) - corrected(network, other)).abs()[0, 0].amax(0)
    assert difference[:32].max() < 1e-5 < difference[63], difference


def check_rims():
    """Rims are those of an erosion; a pinhole far from all outlines costs more than a step in one."""
    from train_outlines import RIM, loss_of, rim_of

    side, truth = 96, np.ones((96, 96), np.uint8)
    truth[:, :20] = 0
    drivable = torch.from_numpy(truth[None]).float()
    inner = cv2.erode(truth, np.ones((2 * RIM + 1, 2 * RIM + 1)), borderType=cv2.BORDER_CONSTANT, borderValue=1)
    assert (rim_of(drivable)[0].numpy() == truth - inner).all()

    def loss(changed):
        found = drivable.clone()
        found[0][changed] = 1 - found[0][changed]
        ones = torch.ones(1, side, side)
        return loss_of(20 * (found - 0.5), ones, torch.from_numpy(truth[None]), ones).item()

    assert loss(np.s_[:0, :0]) < 1e-3 < loss(np.s_[48:50, 20:22]) < loss(np.s_[48:50, 60:62]) / 3


def main():
    training = pathlib.Path(sys.argv[1])
    check_weights(training)
    check_level_views()
    check_bands_on_the_ground()
    check_fields()
    check_kerbs()
    check_thin_car()
    check_islands()
    check_recycling()
    check_classes()
    check_fold()
    check_composed()
    check_rims()
    from network import load

    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        rng = np.random.default_rng(1)
        for part in ("train", "val"):
            for name in "abc":
                write_picture(folder / "camvid" / part, name, rng)

        def run(script, *arguments):
            command = [sys.executable, "-B", str(training / script), *map(str, arguments)]
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            assert done.returncode == 0, done.stderr
            return done.stdout

        log = run("train.py", "--camvid", folder / "camvid", "--drives", folder, "--steps", 2, "--batch", 2, "--out", folder / "a.pt")
        assert "step 2" in log and "camvid" in log, log
        folded = ("--resume", folder / "a.pt", "--fold", "--begin", 1)
        log = run("train.py", "--camvid", folder / "camvid", "--drives", folder, "--steps", 1, "--batch", 2, *folded, "--out", folder / "b.pt")
        assert "step 1" in log, log
        assert "difference" in run("export.py", folder / "b.pt", folder / "b.onnx")
        assert "difference" in run("export.py", folder / "a.pt", folder / "a.onnx")
        again = ("--resume", folder / "b.onnx", "--begin", 1, "--bfloat16")
        log = run("train.py", "--camvid", folder / "camvid", "--drives", folder, "--steps", 1, "--batch", 2, *again, "--out", folder / "d.pt")
        assert "step 1" in log, log
        level = ("--resume", folder / "b.onnx", "--level")
        log = run("train.py", "--camvid", folder / "camvid", "--drives", folder, "--steps", 1, "--batch", 2, *level, "--out", folder / "l.pt")
        assert "step 1" in log, log
        assert "832x288" in run("export.py", folder / "l.pt", folder / "l.onnx")
        mix = ("--mix", folder / "b.onnx", 0.25, "--mix", folder / "d.pt", 0.5)
        assert "832x288" in run("export.py", folder / "l.pt", folder / "m.onnx", *mix)
        weights = [load(folder / name).head.weight for name in ("l.pt", "b.onnx", "d.pt", "m.onnx")]
        assert torch.allclose(weights[3], 0.25 * weights[0] + 0.25 * weights[1] + 0.5 * weights[2], atol=1e-6)
        figures = run("evaluate.py", folder / "a.onnx", "--camvid", folder / "camvid/val")
        assert "3 pictures, IoU" in figures and "mean of classes" in figures, figures
        (folder / "no_drives").mkdir()
        packed = run("pack.py", "--camvid", folder / "camvid/train", "--drives", folder / "no_drives", "--out", folder / "pictures.zip")
        assert "MB" in packed, packed
        from pictures import load_camvid, load_pack

        plain, fisheye = load_pack(folder / "pictures.zip")
        assert [picture.name for picture in plain] == ["a", "b", "c"] and not fisheye
        for packed, original in zip(plain, load_camvid(folder / "camvid/train")):
            assert (packed.classes == original.classes).all() and (packed.label == original.label).all()
            assert np.abs(packed.image.astype(int) - original.image).mean() < 6
        pool = ("--pack", folder / "pictures.zip", "--pool", 32, "--workers", 1, "--without", "b")
        log = run("train.py", *pool, "--steps", 1, "--batch", 2, "--begin", 0.1, "--out", folder / "p.pt")
        assert "2 plain pictures" in log and "step 1" in log, log

        from outline_network import load as load_outlines

        (folder / "rasters").mkdir()
        check_outlines(folder / "rasters")
        ground = ("--rasters", folder / "rasters", "--val", folder / "rasters", "--batch", 2)
        log = run("train_outlines.py", *ground, "--steps", 2, "--out", folder / "c.pt")
        assert "step 2" in log and "boundary" in log, log
        assert "step 1" in run("train_outlines.py", *ground, "--steps", 1, "--resume", folder / "c.pt", "--out", folder / "c.pt")
        assert "difference" in run("export_outlines.py", folder / "c.pt", folder / "c.onnx")
        again = ("--resume", folder / "c.onnx", "--bfloat16")
        assert "step 1" in run("train_outlines.py", *ground, "--steps", 1, *again, "--out", folder / "e.pt")
        assert "difference" in run("export_outlines.py", folder / "e.pt", folder / "e.onnx")
        assert "difference" in run("export_outlines.py", folder / "e.pt", folder / "f.onnx", "--mix", folder / "c.onnx")
        weights = [load_outlines(folder / f"{name}.onnx").head.weight for name in "cef"]
        assert torch.allclose(weights[2], 0.5 * (weights[0] + weights[1]), atol=1e-6)


if __name__ == "__main__":
    main()
