"""Faults that logs of the field have: one module per kind of what is wrong."""

from . import cameras, clocks, encodings, files, gnss, imu, rigs, wheels

KINDS = {module.__name__.split(".")[-1]: module.FAULTS
         for module in (clocks, imu, wheels, gnss, cameras, encodings, rigs, files)}
