"""A page of somebody else, in a browser on the user's machine, that tries what such a page can on a server of ours."""

import threading
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from urllib.parse import urlsplit

STRANGER = "stranger.test"
"""A name that the browser of these tests takes for this machine, as after DNS rebinding."""

RESOLVED = f"--host-resolver-rules=MAP {STRANGER} 127.0.0.1"

TRIES = """async (addresses) => {
  const told = [];
  const within = (promise) => Promise.race([promise, new Promise((done) => setTimeout(() => done("nothing"), 4000))]);
  for (const address of addresses) {
    const ask = (options) => fetch(address, options).then(
      async (answer) => answer.type === "opaque" ? "opaque" : answer.status + " " + (await answer.text()).slice(0, 99),
      () => "blocked");
    told.push(["fetch", address, await within(ask({}))]);
    told.push(["fetch no-cors", address, await within(ask({mode: "no-cors"}))]);
    told.push(["post", address, await within(ask({method: "POST", body: "x"}))]);
    told.push(["img", address, await within(new Promise((done) => {
      const img = new Image(); img.onload = () => done("shown"); img.onerror = () => done("blocked"); img.src = address;
    }))]);
    told.push(["socket", address, await within(new Promise((done) => {
      const socket = new WebSocket(address.replace("http", "ws"), SUBPROTOCOLS);
      socket.onopen = () => done("open"); socket.onmessage = () => done("read");
      socket.onerror = () => done("blocked");
    }))]);
    const frame = document.createElement("iframe");
    frame.name = "f" + told.length; document.body.append(frame);
    const form = document.createElement("form");
    form.method = "post"; form.action = address; form.target = frame.name; document.body.append(form); form.submit();
    await within(new Promise((done) => { frame.onload = () => done(""); }));
    const shown = document.createElement("iframe"); shown.src = address; document.body.append(shown);
    await within(new Promise((done) => { shown.onload = () => done(""); }));
    let read = "blocked";
    try { read = shown.contentWindow.document.body.innerText; }
    catch (error) { read = "blocked"; }
    told.push(["iframe", address, read]);
  }
  return told;
}"""

HARMLESS = {"blocked", "opaque", "nothing", ""}


@contextmanager
def foreign_server():
    """A server of an empty page on a port of its own; its port."""

    class Page(BaseHTTPRequestHandler):
        def do_GET(self):
            self.send_response(200)
            self.send_header("Content-Type", "text/html")
            self.end_headers()
            self.wfile.write(b"<!doctype html><title>somebody else</title><body></body>")

        def log_message(self, *_):
            pass

    server = ThreadingHTTPServer(("127.0.0.1", 0), Page)
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    try:
        yield server.server_port
    finally:
        server.shutdown()
        server.server_close()


def tried(browser, url, subprotocols=()):
    """What foreign pages get from the server at an address, whether they know its secret or not; see `HARMLESS`."""
    served = urlsplit(url)
    addresses = [
        f"http://{host}:{served.port}{path}"
        for host in ("127.0.0.1", "localhost", STRANGER)
        for path in ("/", "/" + "a" * 32 + "/", served.path)
    ]
    told = []
    with foreign_server() as port:
        for host in ("127.0.0.1", STRANGER):
            page = browser.new_page()
            page.goto(f"http://{host}:{port}/")
            told += page.evaluate(TRIES.replace("SUBPROTOCOLS", str(list(subprotocols))), addresses)
            page.close()
    return told


def rebound(browser, url):
    """Status and text of the server's own page under a stranger's name, and under this machine's without the secret."""
    served = urlsplit(url)
    found = []
    for address in (
        f"{STRANGER}:{served.port}{served.path}",
        f"{STRANGER}:{served.port}/",
        f"127.0.0.1:{served.port}/",
    ):
        page = browser.new_page()
        answer = page.goto(f"http://{address}")
        found.append((answer.status, page.inner_text("body").strip()))
        page.close()
    return found
