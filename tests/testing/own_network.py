"""A network namespace of its own for a test whose programs use fixed ports."""
import fcntl
import os
import socket
import struct
import subprocess
import sys

MARK = "GRASPDB_OWN_NETWORK"


def enter():
    """Runs the program again in a new namespace with a loopback device, where the kernel allows one."""
    unshare = ["unshare", "--net", "--map-root-user"]
    if MARK in os.environ:
        siocsifflags, iff_up = 0x8914, 1  # linux/sockios.h, linux/if.h
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
            fcntl.ioctl(any_socket, siocsifflags, struct.pack("16sH14x", b"lo", iff_up))
    elif subprocess.run(unshare + ["true"], stderr=subprocess.DEVNULL).returncode == 0:
        os.environ[MARK] = "1"
        os.execvp("unshare", unshare + [sys.executable] + sys.argv)
