"""Colors of pictures while they are changed: in single precision, where NumPy takes to double whenever a factor is one."""
import numpy as np


def to_bytes(values):
    """0..255, cut off there, of what is float32; `values` are overwritten."""
    assert values.dtype == np.float32
    return np.clip(values, 0, 255, out=values).astype(np.uint8)


def normals(rng, mean, sigma, count=None):
    """`count` normal numbers (None: one), float32."""
    return np.float32(rng.normal(mean, sigma, count))
