# Print the joint angles that limbd streams, in degrees; needs nothing but pyzmq and msgpack.
import math
import struct
import sys

import msgpack
import zmq

socket = zmq.Context().socket(zmq.SUB)
socket.connect(sys.argv[1] if sys.argv[1:] else "tcp://127.0.0.1:5770")
socket.subscribe("limb/frames")
while True:
    frames = msgpack.unpackb(socket.recv_multipart()[1])
    *_, q = struct.iter_unpack(f"<{frames['q']['shape'][1]}d", frames["q"]["data"])  # the block's last
    print(frames["frame0"], *(f"{math.degrees(angle):.2f}" for angle in q), flush=True)
