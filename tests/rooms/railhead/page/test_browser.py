"""The page in a browser: Debian's chromium without a window, driven by selenium."""

import shlex
import shutil
import signal
import subprocess
from contextlib import contextmanager
from pathlib import Path

import command
import psutil
import pytest
from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.support.ui import WebDriverWait

CHROMIUM, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
FLAGS = "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"
CONTROLS = "input, select, textarea, button, pre[tabindex], .plot"
ROOT = Path(__file__).parents[4]
pytestmark = [
    pytest.mark.system,
    pytest.mark.skipif(not (CHROMIUM and DRIVER), reason="no chromium and chromium-driver here"),
]


@pytest.fixture(scope="module")
def browser():
    options = webdriver.ChromeOptions()
    for flag in (*FLAGS, "--window-size=1300,1000"):
        options.add_argument(flag)
    options.binary_location = CHROMIUM
    driver = webdriver.Chrome(options=options, service=Service(DRIVER))
    yield driver
    driver.quit()


class Shown:
    """A page in a browser, and the process that serves it."""

    def __init__(self, browser, process) -> None:
        self.browser, self.process = browser, process

    def text(self, name: str) -> str:
        return str(self.script(f"return at('{name}').textContent"))

    def script(self, text: str, *values: object) -> object:
        return self.browser.execute_script(text, *values)

    def until(self, condition: str, seconds: float = 90.0) -> None:
        wait = WebDriverWait(self.browser, seconds, 0.05)
        wait.until(lambda _: self.script(f"return {condition}"), condition)

    def put(self, name: str, value: object, event: str = "change") -> None:
        text = "at(arguments[0]).value = arguments[1]; at(arguments[0]).dispatchEvent(new Event("
        self.script(text + "arguments[2]))", name, value, event)

    def answered(self) -> None:
        self.until("Number(document.body.dataset.answered) === number && number > 0")

    def children(self) -> list[psutil.Process]:
        return self.process.children(recursive=True)


@contextmanager
def showing(browser, folder, case: str):
    """The page of a case, answered once. At the end Ctrl-C must end all that was started."""
    served = subprocess.Popen(
        [*command.START, "page", case, "--no-open"],
        cwd=folder, env=command.environment(), stdout=subprocess.PIPE, text=True,
    )  # fmt: skip
    process = psutil.Process(served.pid)
    try:
        browser.get(served.stdout.readline().strip())
        shown = Shown(browser, process)
        shown.answered()
        yield shown
    finally:
        begun = process.children(recursive=True)
        served.send_signal(signal.SIGINT)
        assert served.wait(60) == 0
        _, left = psutil.wait_procs(begun, 30)
        assert not [each for each in left if each.status() != psutil.STATUS_ZOMBIE]


def test_after_ten_moves_the_number_is_that_of_the_command_for_the_last_one(
    browser, here, capsys
) -> None:
    with showing(browser, here, "uic54_thesis") as shown:
        (listening,) = (each for each in shown.process.net_connections() if each.status == "LISTEN")
        assert listening.laddr.ip == "127.0.0.1"
        for tenth in range(10):
            shown.put("shift", str(2 + tenth / 10), "input")
        shown.answered()
        words = shlex.split(shown.text("command"))
        assert words[:2] == ["railhead", "run"] and "wheelset.shift=2.9 mm" in words
        summary = command.told(capsys, *words[1:], "--no-pictures")
        found = summary["result"]["pressure"]["max_MPa"]
        assert shown.text("max-pressure") == str(found) and shown.text("error") == ""


@pytest.mark.slow
def test_wrong_input_marks_its_field(browser, tmp_path) -> None:
    with showing(browser, tmp_path, "s1002_60e1") as shown:
        shown.put("load-text", "10 mm")
        shown.until("at('error').textContent")
        refused = command.process("run", "s1002_60e1", "--set", "load=10 mm", cwd=tmp_path)
        assert shown.text("error") == refused.stderr.strip()
        marked = "[...document.querySelectorAll('[aria-invalid=true]')].map(each => each.id)"
        assert shown.script(f"return {marked}") == ["load-text"]
        shown.put("load-text", "20 kN")
        shown.until("!at('error').textContent")
        shown.put("more", "wheel.profile=none\nload=0")  # the radii do not depend on the load
        shown.until("errors.radii && errors.rigid")
        shown.put("more", "wheel.profile=none\nload=10")
        shown.until("!at('error').textContent")
        shown.put("more", "")
        shown.put("roll-text", "2 mrad")
        shown.until("at('command').textContent.includes('roll')")
        shown.put("roll-text", "")  # none is set
        shown.until("!at('command').textContent.includes('roll')")
        (tmp_path / "bad.csv").write_text("nothing\n")
        browser.find_element("id", "upload").send_keys(str(tmp_path / "bad.csv"))
        shown.until("at('error').textContent.includes('bad.csv')")
        good = ROOT / "examples" / "worn_60e1.csv"
        browser.find_element("id", "upload").send_keys(str(good))
        shown.until("!at('error').textContent")
        assert "noise" in shown.text("profile")
        shown.until(f"at('command').textContent.includes('{good.name}')")


@pytest.mark.slow
def test_a_run_ends_with_its_report_and_stop_or_closing_ends_it(browser, tmp_path) -> None:
    with showing(browser, tmp_path, "hertz_ellipse") as shown:
        idle = len(shown.children())
        shown.put("more", "mesh.patch_size=0.6")
        shown.script("at('solve').click()")
        shown.until("at('report').src && !at('report').hidden", 120)
        browser.switch_to.frame("report")
        assert "All 25 checks hold" in browser.page_source
        browser.switch_to.default_content()
        assert shown.script("return at('space').data.length") == 3
        shown.put("more", "mesh.patch_size=0.3")  # a long run
        for end in ("at('stop').click()", "location.href = 'about:blank'"):
            shown.script("at('solve').click()")
            shown.until("at('progress').textContent.startsWith('[')")
            assert len(shown.children()) > idle
            shown.script(end)
            WebDriverWait(browser, 60).until(lambda _: len(shown.children()) == idle)
        assert not list(tmp_path.iterdir())


@pytest.mark.slow
@pytest.mark.parametrize("width", [1300, 420])
def test_the_layout_fits_and_every_control_has_a_name(browser, tmp_path, width: int) -> None:
    """Its pictures are those of docs/page, at fewer colours."""
    size = {"width": width, "height": 960, "deviceScaleFactor": 1, "mobile": False}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    with showing(browser, tmp_path, "s1002_60e1") as shown:
        shown.put("load-text", "60 kN")
        shown.put("shift", "6", "input")
        shown.answered()
        shown.until("at('plan').textContent && at('jumps').textContent && !jobs.plan.busy")
        assert shown.script("return document.documentElement.scrollWidth <= innerWidth")
        for each in browser.find_elements("css selector", CONTROLS):
            assert not each.is_displayed() or each.accessible_name, each.get_attribute("id")
        browser.save_screenshot(str(tmp_path / f"{width}.png"))
