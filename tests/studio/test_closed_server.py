"""Viser serves the page at the printed address and nobody else, and does what that page may ask and nothing else."""

import threading
import time
from urllib.parse import urlsplit

import pytest
from raw_requests import UPGRADE, asked, get, malformed, refusals, status

viser = pytest.importorskip("viser")

import msgspec  # noqa: E402, comes with viser
from websockets.exceptions import WebSocketException  # noqa: E402
from websockets.sync.client import connect  # noqa: E402

from frontal_biped.exceptions import FrontalBipedError  # noqa: E402
from frontal_biped.studio.closed_server import closed_server  # noqa: E402
from frontal_biped.viewer.guard import HEADERS, REFUSED, Guard  # noqa: E402
from frontal_biped.viewer.ports import HOST, listening_socket  # noqa: E402

PATIENCE = 20.0  # [s] on a busy machine

CAMERA = {
    "type": "ViewerCameraMessage", "wxyz": [1, 0, 0, 0], "position": [1.0, 0, 0], "fov": 1.0, "near": 0.01, "far": 1e3,
    "image_height": 100, "image_width": 100, "look_at": [0, 0, 0], "up_direction": [0, 0, 1],
}  # fmt: skip


@pytest.fixture
def served():
    listening, port = listening_socket(0, 8300, "")
    guard = Guard()
    server = closed_server(guard, listening, "a studio")
    yield server, guard.address(HOST, port)
    server.stop()


def opened(url, **options):
    protocol = f"viser-v{viser.__version__}"
    return connect(url.replace("http", "ws"), subprotocols=[protocol], max_size=None, compression=None, **options)


def until(done):
    end = time.monotonic() + PATIENCE
    while not done() and time.monotonic() < end:
        time.sleep(0.02)
    return done()


def test_the_page_and_its_web_socket_are_served(served):
    _, url = served
    port = urlsplit(url).port
    for host in (f"127.0.0.1:{port}", "localhost:1"):
        page = get(url, f"Host: {host}")
        assert status(page) == 200 and "<title>Viser</title>" in page
        for name, value in HEADERS.items():
            assert f"{name}: {value}" in page
        scene = get(url, f"Host: {host}", f"Origin: http://{host}", *UPGRADE.split("\r\n")[:-1])
        assert status(scene) == 101


def test_nobody_else_is_told_anything(served, capfd):
    _, url = served
    for name, answer in refusals(url).items():
        assert status(answer) == 403 and answer.endswith(f"\r\n\r\n{REFUSED}"), name
        for header in HEADERS:
            assert f"\r\n{header}:" in answer, name
    assert capfd.readouterr() == ("", "")


def test_what_is_no_request_gets_nothing_and_does_no_harm(served, capfd):
    _, url = served
    for name, answer in malformed(url).items():
        assert status(answer) in (0, 400, 403), name
        assert "viser" not in answer.lower() and "back" not in answer, name
    assert status(get(url, f"Host: 127.0.0.1:{urlsplit(url).port}")) == 200
    assert capfd.readouterr() == ("", "")


def test_no_file_of_the_disk_is_served(served):
    _, url = served
    parts = urlsplit(url)
    climb = "../" * 12
    spelt = [
        climb.replace("..", dots).replace("/", slash)
        for dots in ("..", "%2e%2e", "%252e%252e")
        for slash in ("/", "%2f", "%5c", "\\")
    ]
    for way in (*spelt, "/", "//", "file:///", "%00"):
        answer = asked(parts.port, f"GET {parts.path}{way}etc/passwd HTTP/1.1\r\nHost: localhost\r\n\r\n")
        assert status(answer) in (403, 404, 500) and "root:" not in answer, way


def test_a_page_moves_its_camera_and_its_sliders(served):
    server, url = served
    slider = server.gui.add_slider("s", 0.0, 1.0, 0.1, 0.5)
    range_ = server.gui.add_multi_slider("r", 0.0, 1.0, 0.1, (0.2, 0.8))
    choice = server.gui.add_dropdown("d", ("a", "b"))
    pressed = []
    server.gui.add_button("b").on_click(lambda event: pressed.append(event))
    button = next(h for h in server.gui._gui_input_handle_from_uuid.values() if h._impl.is_button)
    keys = []
    command = server.gui.add_command("go", hotkey="arrowup")
    command.on_trigger(lambda event: keys.append(event))
    with opened(url) as page:
        page.send(msgspec.msgpack.encode(CAMERA))
        assert until(lambda: len(server.get_clients()) == 1)
        for handle, value in ((slider, 0.7), (range_, [0.3, 0.4]), (choice, "b"), (button, True)):
            update = {"type": "GuiUpdateMessage", "uuid": handle._impl.uuid, "updates": {"value": value}}
            page.send(msgspec.msgpack.encode(update))
        page.send(msgspec.msgpack.encode({"type": "CommandTriggerMessage", "uuid": command._impl.uuid}))
        assert until(lambda: (slider.value, range_.value, choice.value) == (0.7, (0.3, 0.4), "b") and pressed and keys)


def test_what_its_page_never_says_is_not_heard(served, monkeypatch, capfd):
    server, url = served
    slider = server.gui.add_slider("s", 0.0, 1.0, 0.1, 0.5)
    shared = []
    monkeypatch.setattr(server, "request_share_url", lambda *_, **__: shared.append("shared"))
    uploaded = threading.Event()
    server.gui.add_upload_button("u").on_upload(lambda _: uploaded.set())
    uuid = slider._impl.uuid

    def update(**updates):
        return {"type": "GuiUpdateMessage", "uuid": uuid, "updates": updates}

    said = [
        {"type": "ShareUrlRequest"},
        {"type": "RunJavascriptMessage", "source": "0"},
        {"type": "FileTransferStartUpload", "source_component_uuid": uuid, "transfer_uuid": "t", "filename": "../x",
         "mime_type": "", "part_count": 1, "size_bytes": 10**15},
        update(sync_cb=None), update(update_cb=[]), update(removed=True), update(visible=False), update(value=None),
        update(value="x"), update(value=[]), update(value=[1, 2, 3]), update(value={"a": 1}), update(value=b"x"),
        update(value=float("nan")), update(value=float("inf")), update(value=[0.1, float("nan")]),
        {**update(value=1.0), "uuid": 7}, {**update(value=1.0), "more": 1}, {"type": "GuiUpdateMessage"},
        {"type": "CommandTriggerMessage"}, {"type": "CommandTriggerMessage", "uuid": 1},
        {"type": "CommandTriggerMessage", "uuid": "no such command"},
        {**CAMERA, "position": [0, 0, float("nan")]}, {**CAMERA, "position": ["a", "b", "c"]}, {**CAMERA, "fov": None},
        {"type": "NoSuchMessage"}, {"type": 1}, {}, [], 1, None, "x", {"no": "type"},
    ]  # fmt: skip
    raw = [msgspec.msgpack.encode(message) for message in said]
    raw += [b"", b"\xc1", b"\x91" * 60_000, b"\x81\xa4type", raw[3][:-1], b"x" * 60_000, "text", "{}"]
    with opened(url) as page:
        page.send(msgspec.msgpack.encode(CAMERA))
        assert until(lambda: len(server.get_clients()) == 1)
        for message in raw:
            page.send(message)
        page.send(msgspec.msgpack.encode(update(value=0.75)))  # heard after all of it
        assert until(lambda: slider.value == 0.75)
        client = next(iter(server.get_clients().values()))
        assert client.camera.position.tolist() == [1.0, 0.0, 0.0]
        assert slider.visible and shared == [] and not uploaded.is_set()
    # one that is too long ends its connection, and that alone
    with pytest.raises(WebSocketException), opened(url) as page:
        page.send(b"x" * 10_000_000)
        while True:
            page.recv(timeout=PATIENCE)
    assert status(get(url, f"Host: 127.0.0.1:{urlsplit(url).port}")) == 200
    assert capfd.readouterr() == ("", "")


def test_a_viser_that_starts_in_another_way_is_not_served(monkeypatch):
    stopped = []

    class Elsewhere:
        """Viser as it might be one day: it does not ask for ``serve`` where it is put."""

        def __init__(self, **_):
            pass

        def stop(self):
            stopped.append(True)

    monkeypatch.setattr(viser, "ViserServer", Elsewhere)
    listening, _ = listening_socket(0, 8300, "")
    with listening, pytest.raises(FrontalBipedError, match=r"^viser \S+ cannot be closed to other web pages; install"):
        closed_server(Guard(), listening, "a studio")
    assert stopped


def test_a_server_that_answers_strangers_is_stopped(monkeypatch):
    monkeypatch.setattr("frontal_biped.studio.closed_server._guarded", lambda guard, answer: answer)
    listening, port = listening_socket(0, 8300, "")
    with pytest.raises(FrontalBipedError, match="cannot be closed to other web pages"):
        closed_server(Guard(), listening, "a studio")
    listening_socket(port, 1, "")[0].close()  # it is free again
