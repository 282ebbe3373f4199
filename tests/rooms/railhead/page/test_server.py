"""The page's server: its token, and answers that are those of the command."""

import asyncio
import base64
import shlex
import socket
from concurrent.futures import ThreadPoolExecutor
from contextlib import asynccontextmanager, contextmanager
from pathlib import Path

import command
import numpy as np
import psutil
import pytest
from aiohttp import WSServerHandshakeError
from aiohttp.test_utils import TestClient, TestServer

from railhead.cli import commands
from railhead.page import server
from railhead.scene.scene import SceneError

TOKEN, ROOT = "a-token", Path(__file__).parents[4]


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


def asked(root, kind, case="s1002_60e1", more=None, **values):
    """The answer to one message of a page, of a server of its own."""
    root.mkdir(exist_ok=True)

    async def ask():
        async with serving(root, case) as client, client.ws_connect(f"/{TOKEN}/socket") as page:
            await page.send_json({"kind": kind, "number": 1, "values": values, **(more or {})})
            return await page.receive_json()

    return asyncio.run(ask())


@pytest.mark.parametrize("path", ["/", "/wrong/", "/plotly.min.js", "/wrong/socket", f"/{TOKEN}x/"])
def test_without_the_token_the_answer_is_403(tmp_path, path: str) -> None:
    async def statuses():
        async with serving(tmp_path) as client:
            with pytest.raises(WSServerHandshakeError, match="403"):
                await client.ws_connect("/wrong/socket")
            return [(await client.get(each)).status for each in (path, f"/{TOKEN}/")]

    assert asyncio.run(statuses()) == [403, 200]


@pytest.mark.parametrize(
    "header", [{"Host": "rebound.example"}, {"Origin": "http://other.example"}]
)
def test_a_page_of_another_site_gets_403_with_the_token_too(tmp_path, header: dict) -> None:
    async def tried() -> int:
        async with serving(tmp_path) as client:
            with pytest.raises(WSServerHandshakeError, match="403"):
                await client.ws_connect(f"/{TOKEN}/socket", headers=header)
            return (await client.get(f"/{TOKEN}/", headers=header)).status

    assert asyncio.run(tried()) == 403


def test_the_command_names_a_scene_so_that_every_folder_finds_it(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "kept").mkdir()
    (tmp_path / "kept" / "scene.toml").write_text("load = 4000.0\n")
    served: list[str] = []
    monkeypatch.setattr(server, "application", lambda case, *_: served.append(case))
    monkeypatch.setattr(server.web, "run_app", lambda *_, sock, **__: sock.close())
    for case in ("kept", "s1002_60e1"):
        server.serve(case, 0, opened=False)
    assert served == [str(tmp_path / "kept" / "scene.toml"), "s1002_60e1"]
    (tmp_path / "sweep").mkdir()
    with pytest.raises(SceneError, match="case: 'sweep' has no scene.toml; give the folder of a"):
        server.serve("sweep", 0, opened=False)


def test_sliders_reach_the_values_of_their_scene_and_stand_where_units_say(tmp_path) -> None:
    sliders = asked(tmp_path, "controls", load="300 kN")["data"]["sliders"]
    assert {each["id"]: each["high"] for each in sliders}["load"] == 300.0
    values = {"load": "20000 N", "wheelset.shift": "0.3 cm"}
    stand = asked(tmp_path, "described", **values)["data"]["stand"]
    assert stand == {"position": 0.0, "shift": 3.0, "yaw": 0.0, "roll": None, "load": 20.0}


def test_numbers_are_those_of_the_command_that_is_shown(tmp_path, capsys) -> None:
    values = {"wheelset.shift": "3 mm", "load": "50 kN"}
    shown = asked(tmp_path, "described", **values)["data"]["command"]
    found = asked(tmp_path, "half_spaces", **values)["data"]
    words = [*shlex.split(shown)[1:], "--out", str(tmp_path / "out")]
    summary = command.told(capsys, *words, ends=1)
    assert "the steel would yield" in found["failed"]
    assert found["result"] == summary["result"]
    assert found["estimates"] == summary["accuracy"]["bound"]
    assert summary["scene"]["wheelset"]["shift"] == 3.0


def test_the_picture_of_the_pressure_carries_the_load(tmp_path) -> None:
    found = asked(tmp_path, "half_spaces", **{"wheelset.shift": "3 mm"})["data"]["pressure"]
    cell = (found["x"][1] - found["x"][0]) * (found["s"][1] - found["s"][0])
    carried = cell * sum(value or 0.0 for row in found["pressure"] for value in row)
    assert carried == pytest.approx(10e3, rel=0.01)


def test_what_half_spaces_have_solved_is_planned_for_finite_elements(tmp_path) -> None:
    plans = [asked(tmp_path / name, "plan", **values)["data"]["price"] for name, values in (
        ("as it is", {}), ("as --fast leaves it", {"effects.finite_bodies": "off"}),
    )]  # fmt: skip
    assert plans[0] == plans[1] and not plans[0].startswith("0 ")


def test_without_an_answer_the_page_gets_the_reason(tmp_path, half_spaces_fail) -> None:
    found = asked(tmp_path, "half_spaces", case="uic54_thesis")["data"]
    assert found["result"] == {} and found["pressure"] is None
    assert "NOT CONVERGED: boundary elements: no bounded contact found" in found["failed"]


@pytest.mark.parametrize("kind", ["rigid", "half_spaces", "solve"])
def test_wrong_input_names_its_key_in_the_line_of_the_command(tmp_path, capsys, kind: str) -> None:
    found = asked(tmp_path, kind, **{"wheelset.shift": "60 mm"})["error"]
    line = command.refused(capsys, "run", "s1002_60e1", "--set", "wheelset.shift=60 mm", "--fast")
    assert found == {"key": "wheelset.shift", "line": line}


def test_the_scene_that_is_shown_is_the_one_that_is_answered(tmp_path) -> None:
    values = {"wheelset.yaw": "2 mrad", "rail.profile": "54E1"}
    toml = tmp_path / "s1002_60e1.toml"
    toml.write_text(asked(tmp_path, "described", **values)["data"]["scene"])
    again = asked(tmp_path, "rigid", case=str(toml))["data"]
    there = asked(tmp_path, "rigid", **values)["data"]
    assert again["panels"] == there["panels"]
    assert there["panels"] != asked(tmp_path, "rigid")["data"]["panels"]


def test_contact_points_lie_on_both_outlines(tmp_path) -> None:
    for side in asked(tmp_path, "rigid", **{"wheelset.shift": "4 mm"})["data"]["panels"]:
        for touch in side["touches"]:
            for outline in (*side["rails"], side["wheel"]):
                y, z = np.array(outline, dtype=float)
                order = np.argsort(y)
                assert np.interp(touch["y"], y[order], z[order]) == pytest.approx(
                    touch["z"], abs=0.06
                )


def _file(name: str, content: bytes, body: str = "rail", size: int | None = None) -> dict:
    """What a page sends of a file."""
    text = base64.b64encode(content).decode()
    length = len(content) if size is None else size
    return {"name": name, "content": text, "size": length, "body": body}


def test_an_uploaded_profile_is_kept_under_a_safe_name_and_read_as_by_the_command(
    tmp_path, capsys
) -> None:
    file = ROOT / "examples" / "worn_60e1.csv"
    sent = _file(f"../../{file.name} ü;x.csv", file.read_bytes())
    found = asked(tmp_path / "pages", "upload", more=sent)["data"]
    kept = Path(found["path"])
    assert kept.resolve().is_relative_to(tmp_path / "pages")
    assert kept.name == "worn_60e1.csv_ü_x.csv" and found["key"] == "rail.profile"
    copy = tmp_path / kept.name
    copy.write_bytes(file.read_bytes())
    command.status("profile", str(copy), "--body", "rail", "--out", str(tmp_path / "out"))
    printed = capsys.readouterr().out.splitlines()
    assert found["text"].split() == " ".join(printed[:-1]).split()


def test_a_file_that_is_no_profile_gets_the_line_of_the_command(tmp_path, capsys) -> None:
    wrong = tmp_path / "wrong.csv"
    wrong.write_text("no numbers\n")
    found = asked(tmp_path / "pages", "upload", more=_file(wrong.name, wrong.read_bytes()))
    line = command.refused(capsys, "profile", str(wrong), "--body", "rail")
    assert found["error"]["key"] == "rail.profile"
    assert found["error"]["line"].endswith(line.partition("wrong.csv")[2])
    assert "wrong.csv" in found["error"]["line"]


@pytest.mark.parametrize("size", [server.LARGEST + 1, 5])
def test_a_file_that_is_too_large_or_cut_off_is_not_kept(tmp_path, size: int) -> None:
    found = asked(tmp_path / "pages", "upload", more=_file("a.csv", b"1,2\n", size=size))["error"]
    assert found["key"] == "upload" and str(server.LARGEST) in found["line"]


def test_two_pages_have_folders_of_their_own(tmp_path) -> None:
    async def left() -> list[bool]:
        file = (ROOT / "examples" / "worn_60e1.csv").read_bytes()
        sent = {"kind": "upload", "number": 1, "values": {}, **_file("a.csv", file)}
        async with serving(tmp_path) as client, client.ws_connect(f"/{TOKEN}/socket") as one:
            async with client.ws_connect(f"/{TOKEN}/socket") as other:
                found = []
                for page in (one, other):
                    await page.send_json(sent)
                    found.append(Path((await page.receive_json())["data"]["path"]))
            for _ in range(100):
                if found[1].exists():
                    await asyncio.sleep(0.1)
            return [path.exists() for path in found]

    assert asyncio.run(left()) == [True, False]


@pytest.mark.system
@pytest.mark.parametrize("ending", ["stop", "close"])
def test_a_run_ends_with_its_page(tmp_path, ending: str) -> None:
    async def running() -> None:
        async with serving(tmp_path, "hertz_ellipse") as client:
            async with client.ws_connect(f"/{TOKEN}/socket") as page:
                before = psutil.Process().children(recursive=True)
                await page.send_json({"kind": "solve", "number": 1, "values": {}})
                assert "meshing" in (await page.receive_json())["data"]
                begun = {*psutil.Process().children(recursive=True)} - {*before}
                if ending == "stop":
                    await page.send_json({"kind": "stop", "number": 1, "values": {}})
                    replies = [await page.receive_json() for _ in range(2)]
                    (solved,) = (each for each in replies if each["kind"] == "solve")
                    assert solved["data"]["report"] == ""
            _, left = await asyncio.to_thread(psutil.wait_procs, begun, 30)
            assert begun and not left

    asyncio.run(running())
    assert not list(tmp_path.iterdir())


def test_a_missing_extra_a_port_in_use_and_an_unknown_case_are_one_line(
    tmp_path, capsys, monkeypatch
) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = str(taken.getsockname()[1])
        ran = command.process("page", "--port", port, "--no-open", cwd=tmp_path)
    assert ran.returncode == 2 and ran.stdout == ""
    assert ran.stderr.startswith(f"railhead: --port: {port} cannot be used")
    ran = command.process("page", "nowhere", "--no-open", cwd=tmp_path)
    assert ran.returncode == 2 and ran.stderr.startswith("railhead: case: 'nowhere' is unknown")
    monkeypatch.setattr(commands, "find_spec", lambda _: None)
    assert "pip install 'railhead-contact[page]'" in command.refused(capsys, "page")
