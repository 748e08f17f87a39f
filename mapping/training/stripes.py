"""Paint on floors: long quadrangles of the colours that lines and arrows have."""
import cv2
import numpy as np

COLORS = [(20, 170, 230), (230, 230, 230), (200, 120, 40), (40, 40, 200), (60, 150, 60)]  # BGR


def paint_stripe(rng, picture, corners, where):
    """`picture`, H x W x 3, with a stripe between `corners`, as far as `where`, H x W x 1 of 0 to 1, lets it show."""
    stripe = np.zeros(picture.shape[:2], np.float32)
    cv2.fillConvexPoly(stripe, corners.astype(np.int32), 1.0)
    share = cv2.GaussianBlur(stripe, (3, 3), 0)[..., None] * where * np.float32(rng.uniform(0.4, 0.95))
    color = np.float32(COLORS[rng.integers(len(COLORS))]) * np.float32(rng.uniform(0.5, 1.1))
    return picture * (1 - share) + share * color
