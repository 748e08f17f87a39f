"""Images in every encoding that recorders write, and damaged ones."""

import io
import os
import random
import struct
import subprocess

import numpy
from PIL import Image
from sensor_msgs.msg import Image as ImageMessage

from drive_log import encoded, pixels, repaint
from fault import FaultList

FAULTS = FaultList()
ABOUT = r"\bcam\d|image|JPEG|encoding|decoded|format"


def rgb(image):
    return image if image.ndim == 3 else numpy.repeat(image[..., None], 3, axis=2)


def gray(image):
    return image if image.ndim == 2 else image.mean(axis=2).astype(numpy.uint8)


def packed_yuv(image, luma_first):
    out = numpy.full(image.shape[:2] + (2,), 128, numpy.uint8)
    out[..., 0 if luma_first else 1] = gray(image)
    return out


def bayer(image):
    """RGGB."""
    out, colors = gray(image).copy(), rgb(image)
    out[::2, ::2], out[::2, 1::2] = colors[::2, ::2, 0], colors[::2, 1::2, 1]
    out[1::2, ::2], out[1::2, 1::2] = colors[1::2, ::2, 1], colors[1::2, 1::2, 2]
    return out


def planar(image):
    return numpy.vstack([gray(image), numpy.full((image.shape[0] // 2, image.shape[1]), 128, numpy.uint8)])


RAW = {
    "mono8": gray, "MONO8": gray, "8UC1": gray, "rgb8": rgb, "RGB8": rgb, "8UC3": lambda i: rgb(i)[..., ::-1],
    "bgr8": lambda i: rgb(i)[..., ::-1],
    "rgba8": lambda i: numpy.dstack([rgb(i), gray(i)]), "bgra8": lambda i: numpy.dstack([rgb(i)[..., ::-1], gray(i)]),
    "8UC4": lambda i: numpy.dstack([rgb(i)[..., ::-1], gray(i)]),
    "yuv422": lambda i: packed_yuv(i, False), "uyvy": lambda i: packed_yuv(i, False),
    "yuv422_yuy2": lambda i: packed_yuv(i, True), "yuyv": lambda i: packed_yuv(i, True), "YUYV": lambda i: packed_yuv(i, True),
    "nv12": planar, "nv21": planar, "NV12": planar, "bayer_rggb8": bayer,
    "mono16": lambda i: gray(i).astype("<u2") * 16, "16UC1": lambda i: gray(i).astype("<u2") * 257,
    "bayer_rggb16": lambda i: bayer(i).astype("<u2") * 256,
    "32FC1": lambda i: gray(i).astype("<f4") / 255, "TYPE_40000": gray, "": gray,
}


def as_raw(log, encoding, step_of=None):
    for r in log.images:
        image, packed = pixels(r), RAW[encoding](pixels(r))
        message = ImageMessage(header=r.message.header, height=image.shape[0], width=image.shape[1], encoding=encoding)
        bytes_per_row = packed.nbytes // packed.shape[0]
        message.step = bytes_per_row if step_of is None else step_of(bytes_per_row)
        message.data = packed.tobytes()
        r.message = message


@FAULTS.each("raw images, '{}'", RAW, ABOUT)
def _(log, encoding):
    as_raw(log, encoding)


@FAULTS.add("raw images whose step is 0", ABOUT)
def _(log):
    as_raw(log, "mono8", lambda step: 0)


@FAULTS.add("raw images that are cut off", ABOUT)
def _(log):
    as_raw(log, "mono8")
    for r in log.images:
        r.message.data = r.message.data[: len(r.message.data) // 2]


def rewrite(log, edit, share=1.0, topics=None):
    """Changes the bytes of a share of the compressed images."""
    draw = random.Random(9)
    for k, r in enumerate(log.of(*(topics or log.cameras))):
        if draw.random() < share:
            r.message.data = edit(bytes(r.message.data), k)


def again(data, mode=None, kind="JPEG", **options):
    image = Image.open(io.BytesIO(data))
    return encoded(image.convert(mode) if mode else image, kind, **options)


REWRITTEN = {
    "progressive": lambda d, k: again(d, progressive=True),
    "optimized": lambda d, k: again(d, optimize=True),
    "4:4:4": lambda d, k: again(d, "RGB", subsampling="4:4:4"),
    "4:2:2": lambda d, k: again(d, "RGB", subsampling="4:2:2"),
    "4:1:1": lambda d, k: again(d, "RGB", subsampling="4:1:1"),
    "CMYK": lambda d, k: again(d, "CMYK"),
    "quality 10": lambda d, k: again(d, quality=10),
    "quality 100": lambda d, k: again(d, quality=100),
    "a thumbnail in EXIF": lambda d, k: d[:2] + b"\xff\xe1" + struct.pack(">H", 2 + 6 + len(d[:900])) + b"Exif\0\0" + d[:900] + d[2:],
    "a comment": lambda d, k: d[:2] + b"\xff\xfe\0\x09hello\0\0" + d[2:],
    "the header of AVI": lambda d, k: d[:2] + b"\xff\xe0\0\x10AVI1\0" + bytes(9) + d[2:],
    "bytes behind the end": lambda d, k: d + os.urandom(97),
    "zeros behind the end": lambda d, k: d + bytes(1 + k % 700),
    "two ends": lambda d, k: d + b"\xff\xd9",
    "filled before the end": lambda d, k: d[:-2] + b"\xff" * 7 + b"\xff\xd9",
    "zeros before the end": lambda d, k: d[:-2] + bytes(1 + k % 3) + b"\xff\xd9",
    "without the end": lambda d, k: d[:-2],
}


@FAULTS.each("JPEG: {}", REWRITTEN, ABOUT)
def _(log, what):
    rewrite(log, REWRITTEN[what])


def with_restarts(data, padding):
    image = io.BytesIO()
    Image.open(io.BytesIO(data)).convert("RGB").save(image, "PPM")
    data = subprocess.run(["cjpeg", "-quality", "85", "-restart", "1"], input=image.getvalue(), capture_output=True, check=True).stdout
    begin = data.index(b"\xff\xda")
    out = bytearray(data[:begin])
    for at in range(begin, len(data)):
        if data[at] == 0xFF and at + 1 < len(data) and 0xD0 <= data[at + 1] <= 0xD7:
            out += bytes(padding)
        out.append(data[at])
    return bytes(out)


@FAULTS.each("JPEG: restart markers, {} zeros before each", [0, 2], ABOUT)
def _(log, padding):
    rewrite(log, lambda data, _: with_restarts(data, padding))


def cut(data, _):
    return data[: len(data) * 2 // 3]


def flip(data, k):
    draw, data = random.Random(k), bytearray(data)
    for _ in range(3):
        data[draw.randrange(700, len(data))] ^= 1 << draw.randrange(8)
    return bytes(data)


@FAULTS.each("{} of the images are cut off", [0.05, 0.3, 1.0], ABOUT)
def _(log, share):
    rewrite(log, cut, share)


@FAULTS.each("bits flip in {} of the images", [0.05, 0.3, 1.0], ABOUT)
def _(log, share):
    rewrite(log, flip, share)


@FAULTS.each("{} of the images are empty", [0.05, 1.0], ABOUT)
def _(log, share):
    rewrite(log, lambda data, _: b"", share)


@FAULTS.each("{} of the images are noise", [0.05, 1.0], ABOUT)
def _(log, share):
    rewrite(log, lambda data, _: os.urandom(2000), share)


@FAULTS.each("PNG of {}", ["gray", "RGB", "16 bits", "palette"], ABOUT)
def _(log, kind):
    def png(data, _):
        image = Image.open(io.BytesIO(data))
        if kind == "16 bits":
            return encoded(Image.fromarray(numpy.asarray(image.convert("L")).astype(numpy.uint16) * 257), "PNG")
        return again(data, {"gray": "L", "RGB": "RGB", "palette": "P"}[kind], "PNG")

    rewrite(log, png)
    for r in log.images:
        r.message.format = "png"


@FAULTS.each("images are {}", ["BMP", "GIF", "WEBP", "TIFF"], ABOUT, must_say=False)
def _(log, kind):
    rewrite(log, lambda data, _: again(data, kind=kind))
    for r in log.images:
        r.message.format = kind.lower()


FORMATS = ["", "rgb8; jpeg compressed bgr8", "yuv422_yuy2; jpeg compressed mono8", "jpg", "bayer_rggb8; png compressed", "JPEG", "mjpeg"]


@FAULTS.each("the format is called '{}'", FORMATS, ABOUT)
def _(log, name):
    for r in log.images:
        r.message.format = name


@FAULTS.add("one camera's format is h264, its bytes are none", ABOUT, must_say=True)
def _(log):
    rewrite(log, lambda data, _: b"\0\0\0\1\x67\x42\0\x1e" + os.urandom(300), topics=log.cameras[:1])
    for r in log.of(log.cameras[0]):
        r.message.format = "h264"


@FAULTS.add("one camera is of depth", ABOUT, must_say=True)
def _(log):
    for r in log.of(log.cameras[0]):
        r.message.data = bytes(12) + encoded(Image.fromarray(gray(pixels(r)).astype(numpy.uint16)), "PNG")
        r.message.format = "16UC1; compressedDepth png"


@FAULTS.add("strong compression", ABOUT)
def _(log):
    repaint(log.images, lambda image, _: image, quality=5)
