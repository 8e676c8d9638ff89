#!/usr/bin/env python3
# Sends each frame back unchanged, without the client: a header and its numbers, in a NumPy array if
# NumPy is installed.
import os
import socket
import sys

try:
    import numpy
except ImportError:
    numpy = None

count = 16 + 8 * int(sys.argv[1])
line = socket.socket(fileno=int(os.environ["ISOLINE_FD"]))
room = bytearray(count)
view = memoryview(room)
while True:
    got = line.recv_into(view)
    if got == 0:
        break
    while got < count:
        got += line.recv_into(view[got:])
    y = numpy.frombuffer(view[16:]).copy() if numpy is not None else bytes(view[16:])
    line.sendmsg([view[:16], memoryview(y).cast("B")])
