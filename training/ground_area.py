"""How much ground the pixels of a calibrated camera cover: a map is measured in square meters, not in pixels."""
from pathlib import Path

import cv2
import numpy as np
import yaml

REACH = 14.0  # [m] around the camera; beyond, a map believes little of what a network says
FULL_RANGE = 3.0  # [m] at which a pixel weighs 1; nearer ones no less
MOST = 5.0


def read_rig(folder):
    """Per camera: image size, camera matrix, coefficients of the equidistant fisheye, body_from_camera (4 x 4)."""
    folder = Path(folder)
    imu_from_body = np.array(yaml.safe_load((folder / "vehicle.yaml").read_text())["T_imu_body"])
    cameras = {}
    for name, camera in yaml.safe_load((folder / "camchain-imucam.yaml").read_text()).items():
        fx, fy, cx, cy = camera["intrinsics"]
        matrix = np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1.0]])
        body_from_camera = np.linalg.inv(np.array(camera["T_cam_imu"]) @ imu_from_body)
        cameras[name] = camera["resolution"], matrix, np.array(camera["distortion_coeffs"]), body_from_camera
    return cameras


def weigh_pixels(size, matrix, coefficients, body_from_camera):
    """H x W, float32: the root of the ground that a pixel covers, 1 to MOST; 1 where it shows none within REACH. (The
    root: in proportion to the area, the last meters would count for all.) The plane is z = 0 of body."""
    width, height = size
    u, v = np.meshgrid(np.arange(width), np.arange(height))
    pixels = np.stack([u, v], -1).reshape(-1, 1, 2).astype(np.float64)
    rays = cv2.convertPointsToHomogeneous(cv2.fisheye.undistortPoints(pixels, matrix, coefficients))[:, 0]
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    rays = rays @ body_from_camera[:3, :3].T
    camera_height = body_from_camera[2, 3]
    slope = -rays[:, 2]
    with np.errstate(divide="ignore", invalid="ignore"):
        ground = np.where(slope[:, None] > 0.02, camera_height * rays[:, :2] / slope[:, None], np.nan)
    x, y = ground.reshape(height, width, 2).transpose(2, 0, 1)
    area = np.abs(np.gradient(x, axis=1) * np.gradient(y, axis=0) - np.gradient(x, axis=0) * np.gradient(y, axis=1))
    distance = np.hypot(x, y)
    at_full = np.nanmedian(area[np.abs(distance - FULL_RANGE) < 0.3])
    weights = np.clip(np.sqrt(area / at_full), 1, MOST)
    return np.where((distance < REACH) & np.isfinite(area), weights, 1).astype(np.float32)
