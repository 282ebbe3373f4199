"""The server of the page: on this machine alone, behind a token, one socket for each open page."""

import asyncio
import base64
import hmac
import json
import os
import re
import secrets
import shutil
import socket
import tempfile
import traceback
import webbrowser
from collections.abc import AsyncIterator, Awaitable, Callable
from importlib.resources import files
from pathlib import Path
from typing import Any

from aiohttp import WSMsgType, web
from pebble import ProcessPool

from railhead.cli.errors import WRONG_INPUT
from railhead.page import views
from railhead.page.run import Run
from railhead.results import result_folder
from railhead.scene import catalogue
from railhead.scene.scene import SceneError
from railhead.sweeps import worker_pool

HOSTS = "127.0.0.1", "localhost"
HEARTBEAT = 10.0  # s: a page that does not answer so long is gone
WORKERS = 2  # one for half-spaces, one for what is beside them
LARGEST = 2_000_000  # bytes of a profile file
IN_WORKERS = {
    "controls": views.controls,
    "radii": views.radii,
    "half_spaces": views.half_spaces,
    "share": views.half_spaces,
    "plan": views.plan,
}
"""Views by the word under which a page asks for them."""
AT_ONCE = {"described": views.described, "rigid": views.rigid}
"""The same of this process: they follow a slider."""
POOL = web.AppKey("pool", ProcessPool)
CASE = web.AppKey("case", str)
PAGES = web.AppKey("pages", set)


class Page:
    """One open page: its socket, its folder, its run, and what it has asked for.

    case: as of `railhead run`. socket: to the browser. pool: warm processes. folder: of its own.
    run: finite elements of this page.
    """

    def __init__(
        self, case: str, socket: web.WebSocketResponse, pool: ProcessPool, folder: Path
    ) -> None:
        """Attributes of the class. The folder is made."""
        self.case, self.socket, self.pool, self.folder = case, socket, pool, folder
        self.run, self.files = Run(), 0
        folder.mkdir()

    async def answer(self, asked: dict[str, Any]) -> None:
        """Send what a message asks for, {"kind", "number", "values"}: {"kind", "number", "data"},
        or "error" with the key and the line that the command would print.
        """
        reply = {"kind": asked["kind"], "number": asked["number"]}
        try:
            reply["data"] = await self._found(asked["kind"], asked["values"], asked)
        except Exception as error:
            if not isinstance(error, SceneError):
                traceback.print_exception(error)
            words = " ".join(str(error).split()) or type(error).__name__
            reply["error"] = {"key": getattr(error, "key", ""), "line": f"railhead: {words}"}
        await self.send(reply)

    async def _found(
        self, kind: str, values: dict[str, str], asked: dict[str, Any]
    ) -> dict[str, Any]:
        """The data of an answer. Raises SceneError for wrong input."""
        if kind in AT_ONCE:
            return await asyncio.to_thread(AT_ONCE[kind], self.case, values)
        if kind == "solve":
            return await self._solved(values)
        if kind == "stop":
            await self.run.stop()
            return {}
        if kind == "upload":
            return await self._work(views.profile, self._kept(asked), asked["body"])
        return await self._work(IN_WORKERS[kind], self.case, values)

    async def _work(self, view: Callable[..., dict[str, Any]], *given: Any) -> dict[str, Any]:
        """A view of a warm process."""
        return await asyncio.wrap_future(self.pool.schedule(view, args=given))

    def _kept(self, asked: dict[str, Any]) -> str:
        """Path of a file that was sent, {"name", "content" in base 64}, in the page's folder, with
        _ for characters that names of files need not have. Raises SceneError for a large one.
        """
        content = base64.b64decode(asked["content"])
        if asked["size"] > LARGEST or len(content) != asked["size"]:
            text = f"has {asked['size']} bytes; give a profile of at most {LARGEST}"
            raise SceneError("upload", text)
        self.files += 1
        name = re.sub(r"[^\w.-]", "_", Path(asked["name"]).name).lstrip(".")[-60:]
        path = self.folder / f"file{self.files}" / (name or "profile")
        path.parent.mkdir()
        path.write_bytes(content)
        return str(path)

    async def _solved(self, values: dict[str, str]) -> dict[str, Any]:
        """Solve by finite elements: what the command printed beside its progress, and where its
        report and bodies are; no report where there is no result. Raises SceneError for the line
        of a wrong input.
        """
        self.files += 1
        out = self.folder / f"result{self.files}"
        words = views.arguments(self.case, views.on_meshes(self.case, values))
        words, said = [*words, "--out", str(out)], list[str]()
        async for line in self.run.lines(words):
            if line.startswith("["):
                await self.send({"kind": "progress", "data": line})
            else:
                said.append(line)
        if self.run.status == WRONG_INPUT:
            key, _, text = " ".join(said).removeprefix("railhead: ").partition(": ")
            raise SceneError(key, text)
        if not (out / "report.html").exists():
            return {"text": "\n".join(said) or "stopped", "report": "", "bodies": {}}
        shown = await self._work(views.bodies, str(out))
        report = f"files/{out.relative_to(self.folder.parent)}/report.html"
        return {"text": "\n".join(said), "report": report, "bodies": shown}

    async def send(self, message: dict[str, Any]) -> None:
        """Send a message as JSON, if the page is still open."""
        if not self.socket.closed:
            await self.socket.send_str(result_folder.to_json(message))

    async def close(self) -> None:
        """End what the page has started, and remove its folder."""
        try:
            await self.run.stop()
        finally:
            shutil.rmtree(self.folder, ignore_errors=True)


async def _socket(request: web.Request, root: Path) -> web.WebSocketResponse:
    """Answer a page until it is closed."""
    response = web.WebSocketResponse(heartbeat=HEARTBEAT)
    await response.prepare(request)
    page = Page(request.app[CASE], response, request.app[POOL], root / secrets.token_hex(8))
    request.app[PAGES].add(response)
    jobs: set[asyncio.Task[None]] = set()
    try:
        async for message in response:
            if message.type is WSMsgType.TEXT:
                job = asyncio.create_task(page.answer(json.loads(message.data)))
                jobs.add(job)
                job.add_done_callback(jobs.discard)
    finally:
        request.app[PAGES].discard(response)
        for job in jobs:
            job.cancel()
        await page.close()
    return response


def application(case: str, token: str, root: Path) -> web.Application:
    """The server of a case.
    token: first part of all addresses; without it the answer is 403. root: folder of the pages.
    """

    @web.middleware
    async def with_token(
        request: web.Request, handler: Callable[[web.Request], Awaitable[web.StreamResponse]]
    ) -> web.StreamResponse:
        """The answer of `handler`; 403 without the token, and for the page of another site."""
        first = request.path.strip("/").partition("/")[0]
        if not hmac.compare_digest(first.encode(), token.encode()):
            raise web.HTTPForbidden(text="railhead: the address has a wrong token\n")
        origin = request.headers.get("Origin", f"http://{request.host}")
        if request.url.host not in HOSTS or origin != f"http://{request.host}":
            raise web.HTTPForbidden(text=f"railhead: give an address of {' or '.join(HOSTS)}\n")
        return await handler(request)

    async def page(_: web.Request) -> web.FileResponse:
        """The page itself."""
        return web.FileResponse(Path(__file__).with_name("page.html"))

    async def drawing(_: web.Request) -> web.FileResponse:
        """The library that draws."""
        return web.FileResponse(Path(str(files("plotly") / "package_data" / "plotly.min.js")))

    async def opened(request: web.Request) -> web.WebSocketResponse:
        """The socket of a page."""
        return await _socket(request, root)

    app = web.Application(middlewares=[with_token])
    app[CASE], app[PAGES] = case, set()
    app.router.add_get(f"/{token}/", page)
    app.router.add_get(f"/{token}/plotly.min.js", drawing)
    app.router.add_get(f"/{token}/socket", opened)
    app.router.add_static(f"/{token}/files", root)
    app.cleanup_ctx.append(_workers)
    app.on_shutdown.append(_close)
    return app


async def _workers(app: web.Application) -> AsyncIterator[None]:
    """Processes for as long as the server runs, warmed by the case's own answer."""
    with worker_pool.processes(0, WORKERS) as pool:
        app[POOL] = pool
        for _ in range(WORKERS):
            pool.schedule(views.half_spaces, args=(app[CASE], {}))
        yield
        pool.stop()
        pool.join()


async def _close(app: web.Application) -> None:
    """Close all pages."""
    for each in [*app[PAGES]]:
        await each.close()


def _anywhere(case: str) -> str:
    """A case as the command finds it from every folder: its name, or the absolute path of its file,
    which is the scene of a folder. Raises SceneError for a folder without one.
    """
    path = Path(case)
    if case in catalogue.shipped() or not path.exists():
        return case
    if path.is_dir() and not (path := path / result_folder.SCENE).exists():
        raise SceneError("case", f"{case!r} has no {result_folder.SCENE}; give the folder of a run")
    return str(path.resolve())


def serve(case: str, port: int, *, opened: bool) -> None:
    """Serve the page of a case until Ctrl-C, and print its address.
    case: as of `railhead run`, or the folder of a result. port: 0: one that is free.
    opened: whether a browser is opened, where there is a display.
    Raises SceneError for an unknown case and a port that cannot be used.
    """
    catalogue.find(case := _anywhere(case))
    try:
        listening = socket.create_server(("127.0.0.1", port))
    except OSError as error:
        text = f"{port} cannot be used ({error.strerror}); give another, or none"
        raise SceneError("--port", text) from None
    token = secrets.token_urlsafe(24)
    address = f"http://127.0.0.1:{listening.getsockname()[1]}/{token}/"
    print(f"{address}\nCtrl-C ends it", flush=True)
    if opened and os.environ.keys() & {"DISPLAY", "WAYLAND_DISPLAY"}:
        webbrowser.open(address)
    with tempfile.TemporaryDirectory(prefix="railhead-page-") as root:
        app = application(case, token, Path(root))
        web.run_app(app, sock=listening, print=None, access_log=None, shutdown_timeout=2.0)
