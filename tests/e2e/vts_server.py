"""A VTube Studio for tests, after its public API's documentation: vts_server.py PORT_FILE REPORT. Answers one program
after another; refuses one parameter, and any injection that names one that it does not have."""
import base64
import hashlib
import json
import os
import socket
import struct
import sys

DEFAULTS = ["FaceAngleX", "FaceAngleY", "FaceAngleZ", "MouthOpen", "EyeOpenLeft", "EyeOpenRight", "EyeLeftX", "MouthSmile"]
REFUSED = "MarotteTongueOut"
report = {"tokens": 0, "logins": 0, "created": 0, "injected": 0, "refused": 0, "values": 0, "worst": 0.0}
custom, token, frames = set(), "f" * 64, 0


def exactly(peer, count):
    data = b""
    while len(data) < count:
        part = peer.recv(count - len(data))
        if not part:
            raise ConnectionError
        data += part
    return data


def upgrade(peer):
    head = b""
    while b"\r\n\r\n" not in head:
        head += exactly(peer, 1)
    lines = dict(line.split(": ", 1) for line in head.decode().split("\r\n")[1:] if ": " in line)
    assert lines["Upgrade"].lower() == "websocket" and lines["Sec-WebSocket-Version"] == "13", lines
    key = lines["Sec-WebSocket-Key"] + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11"
    accept = base64.b64encode(hashlib.sha1(key.encode()).digest()).decode()
    peer.sendall(f"HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                 f"Sec-WebSocket-Accept: {accept}\r\n\r\n".encode())


def take(peer):
    first, second = exactly(peer, 2)
    while first == 0x8A:  # a pong: masked, as short as the ping was
        exactly(peer, 4 + (second & 0x7F))
        first, second = exactly(peer, 2)
    assert first == 0x81, f"not a whole text: {first:x}"
    assert second & 0x80, "a client must mask"
    size = second & 0x7F
    if size == 126:
        size = struct.unpack(">H", exactly(peer, 2))[0]
    elif size == 127:
        size = struct.unpack(">Q", exactly(peer, 8))[0]
    mask = exactly(peer, 4)
    return json.loads(bytes(b ^ mask[i % 4] for i, b in enumerate(exactly(peer, size))))


def say(peer, request, kind, data):
    text = json.dumps({"apiName": "VTubeStudioPublicAPI", "apiVersion": "1.0", "timestamp": 1,
                       "requestID": request["requestID"], "messageType": kind, "data": data}).encode()
    size = bytes([len(text)]) if len(text) < 126 else b"\x7e" + struct.pack(">H", len(text))
    peer.sendall(b"\x89\x01!" + b"\x81" + size + text)  # a ping too: it must be borne


def answer(peer, request):
    assert request["apiName"] == "VTubeStudioPublicAPI" and request["apiVersion"] == "1.0"
    kind, data = request["messageType"], request["data"]
    if kind == "AuthenticationTokenRequest":
        assert 3 <= len(data["pluginName"]) <= 32 and 3 <= len(data["pluginDeveloper"]) <= 32
        report["tokens"] += 1
        say(peer, request, "AuthenticationTokenResponse", {"authenticationToken": token})
    elif kind == "AuthenticationRequest":
        report["logins"] += 1
        say(peer, request, "AuthenticationResponse", {"authenticated": data["authenticationToken"] == token, "reason": ""})
    elif kind == "InputParameterListRequest":
        say(peer, request, "InputParameterListResponse",
            {"defaultParameters": [{"name": n, "value": 0, "min": -30, "max": 30, "defaultValue": 0} for n in DEFAULTS],
             "customParameters": [{"name": n} for n in sorted(custom)]})
    elif kind == "ParameterCreationRequest":
        name = data["parameterName"]
        assert 4 <= len(name) <= 32 and name.isalnum(), name
        if name == REFUSED:
            say(peer, request, "APIError", {"errorID": 352, "message": "no"})
        else:
            report["created"] += name not in custom
            custom.add(name)
            say(peer, request, "ParameterCreationResponse", {"parameterName": name})
    elif kind == "InjectParameterDataRequest":
        values = data["parameterValues"]
        if any(v["id"] not in custom and v["id"] not in DEFAULTS for v in values):
            report["refused"] += 1
            say(peer, request, "APIError", {"errorID": 453, "message": "unknown parameter"})
            return
        assert data["mode"] == "set" and data["faceFound"] is True
        report["injected"] += 1
        report["values"] = len(values)
        report["worst"] = max([report["worst"]] + [abs(v["value"]) for v in values if v["id"].startswith("Marotte")])
        say(peer, request, "InjectParameterDataResponse", {})
    else:
        raise AssertionError(kind)


listener = socket.socket()
listener.bind(("127.0.0.1", 0))
listener.listen()
with open(sys.argv[1] + ".new", "w") as file:
    file.write(str(listener.getsockname()[1]))
os.rename(sys.argv[1] + ".new", sys.argv[1])
while True:
    peer, _ = listener.accept()
    peer.settimeout(60)
    try:
        upgrade(peer)
        while True:
            answer(peer, take(peer))
    except (ConnectionError, socket.timeout):
        pass
    except AssertionError as wrong:
        report["wrong"] = str(wrong)
    peer.close()
    with open(sys.argv[2] + ".new", "w") as file:
        json.dump(report, file)
    os.rename(sys.argv[2] + ".new", sys.argv[2])
