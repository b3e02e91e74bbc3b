"""Who may ask: the secret in the path, this machine as the host, its own page as the origin."""

from urllib.parse import urlsplit

import pytest

from frontal_biped.viewer.guard import Guard


@pytest.fixture
def guard():
    return Guard()


def path_of(guard):
    return urlsplit(guard.address("127.0.0.1", 8080)).path


def test_every_start_has_a_secret_of_its_own(guard):
    secrets = {path_of(Guard()) for _ in range(100)}
    assert len(secrets) == 100 and all(len(secret) == 34 for secret in secrets)


@pytest.mark.parametrize("host", ["127.0.0.1:8080", "localhost:8080", "LOCALHOST:8080", "[::1]:8080", "localhost"])
def test_the_page_itself_may_ask(guard, host):
    path = path_of(guard)
    for origins in ([], [f"http://{host}"], [f"http://{host.lower()}"]):
        assert guard.inside(path, [host], origins) == "/"
        assert guard.inside(path.rstrip("/"), [host], origins) == "/"
        assert guard.inside(f"{path}a/b?c=d", [host], origins) == "/a/b?c=d"


def test_a_port_forwarded_under_another_number_works(guard):
    assert guard.inside(path_of(guard), ["localhost:9999"], ["http://localhost:9999"]) == "/"


@pytest.mark.parametrize(
    "hosts",
    [[], ["127.0.0.1:8080", "127.0.0.1:8080"], ["stranger.test"], ["localhost.stranger.test"], ["127.0.0.1:8080:1"],
     ["127.0.0.2"], ["0.0.0.0"], ["localhost:999999"], ["localhost\n"], [""], ["[::1"], ["127.0.0.1, localhost"]],
)  # fmt: skip
def test_other_hosts_may_not(guard, hosts):
    assert guard.inside(path_of(guard), hosts, []) is None


@pytest.mark.parametrize(
    "origins", [["null"], [""], ["http://127.0.0.1:8081"], ["https://127.0.0.1:8080"], ["http://localhost:8080"],
                ["http://stranger.test"], ["http://127.0.0.1:8080"] * 2, ["http://127.0.0.1:8080/"]],
)  # fmt: skip
def test_pages_of_other_servers_may_not(guard, origins):
    assert guard.inside(path_of(guard), ["127.0.0.1:8080"], origins) is None


def test_nobody_may_without_the_secret(guard):
    secret = path_of(guard)
    near = (secret[1:], secret.swapcase(), f"/{secret}", secret[:-2], f"/x{secret}", f"/?{secret}", secret[:17])
    for target in ("", "/", "//", "?", "*", "/é/", "/\udcff/", *near):
        assert guard.inside(target, ["127.0.0.1:8080"], []) is None, target
