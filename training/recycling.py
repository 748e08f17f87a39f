"""Pictures that come back: augmenting one takes a processor core 60 ms, a graphics card learns from thousands a second. A pool
on the card keeps the latest ones, and each time one is drawn it is bent, repainted, shaded and lit anew.
"""
import threading

import torch
from torch.nn import functional

import classes as surfaces
from pictures import UNKNOWN

WEIGHT_STEPS = 20  # of a weight of 1, which are kept as bytes
# Classes that take on a color together, and how often.
REGIONS = ((surfaces.DRIVABLE, surfaces.MARKING, surfaces.ROAD), (surfaces.PAVEMENT, surfaces.KERB, surfaces.PAVED),
           (surfaces.VEGETATION,), (surfaces.STRUCTURE,))
SHARE_REPAINTED = 0.25


class Pool:
    """The latest `capacity` pictures, uint8, on `device`; a thread puts them in while others are drawn."""

    def __init__(self, device, capacity):
        self.device, self.capacity = device, capacity
        self.parts, self.count = None, 0  # count: of all that were put in
        self.lock = threading.Lock()

    def put(self, images, labels, classes, weights):
        """Arrays of N pictures: N x H x W x 3, N x H x W, N x H/2 x W/2, N x H x W."""
        arrays = (torch.from_numpy(images).permute(0, 3, 1, 2), torch.from_numpy(labels), torch.from_numpy(classes),
                  torch.from_numpy(weights).mul(WEIGHT_STEPS).round().to(torch.uint8))
        with self.lock:
            if self.parts is None:
                self.parts = [torch.empty((self.capacity, *array.shape[1:]), dtype=torch.uint8, device=self.device) for array in arrays]
            places = (self.count + torch.arange(len(images))) % self.capacity
            for part, array in zip(self.parts, arrays):
                part[places.to(self.device)] = array.contiguous().to(self.device)
            self.count += len(images)

    def draw(self, count):
        """As put() takes them, but images N x 3 x H x W, and images and weights float."""
        with self.lock:
            places = torch.randint(min(self.count, self.capacity), (count,), device=self.device)
            images, labels, classes, weights = (part[places] for part in self.parts)
        return images.float(), labels, classes, weights.float() / WEIGHT_STEPS


def uniform(like, low, high, channels=1):
    """N x channels x 1 x 1."""
    return low + (high - low) * torch.rand(len(like), channels, 1, 1, device=like.device)


def normal(like, sigma, channels=1):
    return sigma * torch.randn(len(like), channels, 1, 1, device=like.device)


def sometimes(like, share):
    """N x 1 x 1 x 1, 1 with a probability of `share`, else 0."""
    return (torch.rand(len(like), 1, 1, 1, device=like.device) < share).float()


def grid_of(count, size, spread, device):
    """Affine grids for functional.grid_sample: mirrored half of the time; turn, zoom across and along, shifts by `spread`."""
    turn, zoom_x, zoom_y, shift_x, shift_y = spread
    angle = turn * torch.randn(count, device=device)
    side = torch.where(torch.rand(count, device=device) < 0.5, -1.0, 1.0)
    across = torch.exp(zoom_x * (2 * torch.rand(count, device=device) - 1))
    along = torch.exp(zoom_y * (2 * torch.rand(count, device=device) - 1)) if turn == 0 else across
    moved = 2 * torch.rand(2, count, device=device) - 1
    aspect = size[1] / size[0]
    row_x = torch.stack([side * across * angle.cos(), -side * across * angle.sin() / aspect, shift_x * moved[0]], -1)
    row_y = torch.stack([along * angle.sin() * aspect, along * angle.cos(), shift_y * moved[1]], -1)
    return torch.stack([row_x, row_y], 1)


def bend(images, labels, classes, weights, spread):
    """Half of the pictures as they are but for a mirror, the others turned, stretched and shifted; what lies off is unknown."""
    count, (height, width) = len(images), images.shape[2:]
    theta = grid_of(count, (height, width), spread, images.device)
    plain = grid_of(count, (height, width), (0, 0, 0, 0, 0), images.device)
    theta = torch.where(torch.rand(count, 1, 1, device=images.device) < 0.5, plain, theta)

    def sample(values, how, beyond=0):
        values = values if values.ndim == 4 else values[:, None]
        grid = functional.affine_grid(theta, [count, 1, *values.shape[2:]], align_corners=False)
        return functional.grid_sample(values.float() - beyond, grid, mode=how, padding_mode="zeros", align_corners=False) + beyond

    labels = sample(labels, "nearest", UNKNOWN)[:, 0].round().to(torch.uint8)
    classes = sample(classes, "nearest", surfaces.UNKNOWN)[:, 0].round().to(torch.uint8)
    weights = sample(weights, "nearest")[:, 0] * (labels != UNKNOWN)
    return sample(images, "bilinear"), labels, classes, weights


def fields(images, cells):
    """N x 1 x H x W: smooth noise of so many cells across."""
    height, width = images.shape[2:]
    noise = torch.randn(len(images), 1, max(2, cells * height // width), cells, device=images.device)
    return functional.interpolate(noise, size=(height, width), mode="bilinear", align_corners=False)


def repaint(images, classes):
    """Other colors and grain on all that is of a kind: what is road is told by where it lies and what bounds it, not by gray."""
    full = functional.interpolate(classes[:, None].float(), size=images.shape[2:], mode="nearest")
    for region in REGIONS:
        where = sum((full == number).float() for number in region)
        where = functional.avg_pool2d(where, 3, 1, 1, count_include_pad=False) * sometimes(images, SHARE_REPAINTED)
        grain = 1 + uniform(images, 0, 0.15) * fields(images, 160) + uniform(images, 0, 0.12) * fields(images, 24)
        painted = images * torch.exp(normal(images, 0.35) + normal(images, 0.12, 3)) * grain + normal(images, 8)
        images = images + where * (painted - images)
    return images


def cast_shadows(images):
    """One side of a line through the picture in the shade, a quarter of the time, the line as sharp as it may be; and smooth light."""
    height, width = images.shape[2:]
    rows = torch.linspace(-1, 1, height, device=images.device).view(1, 1, -1, 1)
    columns = torch.linspace(-1, 1, width, device=images.device).view(1, 1, 1, -1)
    angle = uniform(images, 0, 6.2832)
    beyond = columns * angle.cos() + rows * angle.sin() - uniform(images, -0.7, 0.7)
    shade = torch.sigmoid(beyond * uniform(images, 20, 300)) * sometimes(images, 0.25) * uniform(images, 0.2, 0.7)
    return images * (1 - shade) * torch.exp(uniform(images, 0, 0.2) * fields(images, 5))


def light(images):
    """Gain, gamma, white balance and gray; then blur and noise."""
    changed = 255 * (images.clamp(0.5, 255) / 255) ** torch.exp(normal(images, 0.2)) * torch.exp(normal(images, 0.2) + normal(images, 0.06, 3))
    images = images + sometimes(images, 0.6) * (changed + normal(images, 6) - images)
    images = images + sometimes(images, 0.08) * (images.mean(1, keepdim=True) - images)
    blurred = functional.avg_pool2d(images, 3, 1, 1, count_include_pad=False)
    images = images + sometimes(images, 0.15) * (blurred - images)
    images = images + sometimes(images, 0.35) * uniform(images, 0, 7) * torch.randn_like(images)
    return images.clamp(0, 255)


def vary(images, labels, classes, weights, spread):
    """Drawn pictures as they were not seen before."""
    images, labels, classes, weights = bend(images, labels, classes, weights, spread)
    off = (images.amax(1, keepdim=True) > 0).float()  # what no lens shows stays black
    return light(cast_shadows(repaint(images, classes))) * off, labels, classes, weights


def resized(images, labels, classes, weights, size):
    """At another size (width, height), whose halves are those of `classes`."""
    width, height = size
    if images.shape[2:] == (height, width):
        return images, labels, classes, weights

    def nearest(values, shape):
        return functional.interpolate(values[:, None].float(), size=shape, mode="nearest")[:, 0]

    return (functional.interpolate(images, size=(height, width), mode="area"), nearest(labels, (height, width)).to(torch.uint8),
            nearest(classes, (height // 2, width // 2)).to(torch.uint8), nearest(weights, (height, width)))
