"""The page's server: its token, and answers that are those of the command."""

import asyncio
import json
import shlex
from concurrent.futures import ThreadPoolExecutor
from contextlib import asynccontextmanager, contextmanager

import command
import numpy as np
import pytest
from aiohttp import WSServerHandshakeError
from aiohttp.test_utils import TestClient, TestServer

from railhead.page import server

TOKEN = "a-token"


class Threads(ThreadPoolExecutor):
    """Threads of this process in the place of processes."""

    def schedule(self, work, args):
        return self.submit(work, *args)

    def stop(self) -> None:
        self.shutdown()

    def join(self) -> None:
        """All is done."""


@pytest.fixture(autouse=True)
def _in_this_process(monkeypatch) -> None:
    @contextmanager
    def threads(*_):
        with Threads(2) as pool:
            yield pool

    monkeypatch.setattr(server.worker_pool, "processes", threads)
    monkeypatch.setattr(server, "WORKERS", 0)  # none to be warmed


@asynccontextmanager
async def serving(root, case="s1002_60e1"):
    """A client of the page of a case."""
    async with TestClient(TestServer(server.application(case, TOKEN, root))) as client:
        yield client


async def _asked(client, kind, number=1, **values):
    """The answer to one message of a page."""
    async with client.ws_connect(f"/{TOKEN}/socket") as socket:
        await socket.send_json({"kind": kind, "number": number, "values": values})
        return await socket.receive_json()


def asked(root, kind, case="s1002_60e1", **values):
    """The same, of a server of its own."""

    async def ask():
        async with serving(root, case) as client:
            return await _asked(client, kind, **values)

    return asyncio.run(ask())


@pytest.mark.parametrize("path", ["/", "/wrong/", "/plotly.min.js", "/wrong/socket", f"/{TOKEN}x/"])
def test_without_the_token_the_answer_is_403(tmp_path, path: str) -> None:
    async def statuses():
        async with serving(tmp_path) as client:
            with pytest.raises(WSServerHandshakeError, match="403"):
                await client.ws_connect("/wrong/socket")
            return [(await client.get(each)).status for each in (path, f"/{TOKEN}/")]

    assert asyncio.run(statuses()) == [403, 200]


def test_numbers_are_those_of_the_command_that_is_shown(tmp_path, capsys) -> None:
    values = {"wheelset.shift": "3 mm", "load": "50 kN"}
    shown = asked(tmp_path, "rigid", **values)["data"]["command"]
    found = asked(tmp_path, "half_spaces", **values)["data"]
    words = [*shlex.split(shown)[1:], "--json", "--out", str(tmp_path / "out")]
    assert command.status(*words) == 1
    assert "the steel would yield" in found["failed"]
    summary = json.loads(capsys.readouterr().out)
    assert found["result"] == summary["result"]
    assert found["estimates"] == summary["accuracy"]["bound"]
    assert summary["scene"]["wheelset"]["shift"] == 3.0


def test_the_picture_of_the_pressure_carries_the_load(tmp_path) -> None:
    found = asked(tmp_path, "half_spaces", **{"wheelset.shift": "3 mm"})["data"]["pressure"]
    cell = (found["x"][1] - found["x"][0]) * (found["s"][1] - found["s"][0])
    carried = cell * sum(value or 0.0 for row in found["pressure"] for value in row)
    assert carried == pytest.approx(10e3, rel=0.01)


@pytest.mark.parametrize("kind", ["rigid", "half_spaces"])
def test_wrong_input_names_its_key_in_the_line_of_the_command(tmp_path, capsys, kind: str) -> None:
    found = asked(tmp_path, kind, **{"wheelset.shift": "60 mm"})["error"]
    line = command.refused(capsys, "run", "s1002_60e1", "--set", "wheelset.shift=60 mm", "--fast")
    assert found == {"key": "wheelset.shift", "line": line}


def test_the_scene_that_is_shown_is_the_one_that_is_answered(tmp_path) -> None:
    values = {"wheelset.yaw": "2 mrad", "rail.profile": "54E1"}
    toml = tmp_path / "s1002_60e1.toml"
    toml.write_text(asked(tmp_path, "rigid", **values)["data"]["scene"])
    again = asked(tmp_path, "rigid", case=str(toml))["data"]
    there = asked(tmp_path, "rigid", **values)["data"]
    assert again["sides"] == there["sides"]
    assert there["sides"] != asked(tmp_path, "rigid")["data"]["sides"]


def test_contact_points_lie_on_both_outlines(tmp_path) -> None:
    for side in asked(tmp_path, "rigid", **{"wheelset.shift": "4 mm"})["data"]["sides"].values():
        for touch in side["touches"]:
            for body in ("rail", "wheel"):
                y, z = np.array(side[body], dtype=float)
                order = np.argsort(y)
                assert np.interp(touch["y"], y[order], z[order]) == pytest.approx(
                    touch["z"], abs=0.06
                )
