"""The add-on's receiver hears what marotte's outputs send: blender -b -P blender_live.py -- PORT_FILE"""
import importlib.util
import os
import socket
import sys
import time

here = os.path.dirname(os.path.abspath(__file__))
spec = importlib.util.spec_from_file_location("marotte_blender", os.path.join(here, "../../ui/blender/marotte_blender.py"))
addon = importlib.util.module_from_spec(spec)
spec.loader.exec_module(addon)

place = sys.argv[sys.argv.index("--") + 1]
listener = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
listener.bind(("127.0.0.1", 0))
with open(place + ".new", "w") as file:
    file.write(str(listener.getsockname()[1]))
os.rename(place + ".new", place)

receiver, faces, began = addon.Receiver(), [], time.monotonic()
listener.settimeout(60)  # until the first; then until nothing comes any more
while time.monotonic() - began < 120:
    try:
        packet = listener.recv(65536)
    except socket.timeout:
        break
    listener.settimeout(2)
    face = receiver.take(packet, time.monotonic())
    if face:
        faces.append(face)

assert receiver.ignored == 0, f"{receiver.ignored} of {receiver.packets} packets make no sense"
assert len(faces) > 20, f"only {len(faces)} faces"
values = faces[-1].values
assert "EyeBlinkLeft" in values, sorted(values)
assert all(a.time < b.time for a, b in zip(faces, faces[1:])), "not in order of time"
lasted = faces[-1].time - faces[0].time
assert 1.0 < lasted < 6.0, f"a take of 3 s lasted {lasted:.2f} s"
if "jaw.open" in values:
    assert max(f.values.get("jaw.open", 0.0) for f in faces) > 0.05, "the jaw does not move"
else:
    assert {"head", "lefteye", "righteye"} <= set(faces[-1].turns), faces[-1].turns
    assert "A" in values and "Blink" in values, sorted(values)
print(f"heard: {len(faces)} faces of {len(values)} values in {lasted:.2f} s")
