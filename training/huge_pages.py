"""Memory in large pages that is kept instead of given back, for trainings: twice as fast on virtual machines, where each
first touch of a page of 4 KB is dear and PyTorch asks for hundreds of megabytes anew at every step."""
import os
import sys

TUNABLES = {"hugetlb": 1, "mmap_threshold": 4 << 30, "trim_threshold": 8 << 30, "top_pad": 256 << 20}  # of glibc's malloc


def use_huge_pages():
    """Starts the program again with them, since malloc reads its settings once; call it before anything else. Settings
    of the caller's own (GLIBC_TUNABLES) are left alone."""
    if "GLIBC_TUNABLES" not in os.environ:
        os.environ["GLIBC_TUNABLES"] = ":".join(f"glibc.malloc.{name}={value}" for name, value in TUNABLES.items())
        os.execv(sys.executable, sys.orig_argv)
