"""The page of a run in a browser: it asks for nothing, moves, and follows a run that goes on."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import pytest
from scenes import case
from shared.served import served

import cdem
from cdem.output.report import report

playwright = pytest.importorskip("playwright.sync_api", reason="needs the extra 'webtest'")
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="needs chromium")
# WebGL on the CPU; as root chromium runs without its sandbox only
OPTIONS = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"]
OPTIONS += ["--no-sandbox"] if os.geteuid() == 0 else []
BLOCKS = [
    {"group": "box", "box": {"size": [1, 1, 1], "divisions": [2, 1, 1]}},
    {"group": "chip", "box": {"size": [1, 1, 1], "shape": "tet4"}, "translate": [2, 0, 2]},
]


@pytest.fixture(scope="module")
def browser():
    with playwright.sync_playwright() as play:
        browser = play.chromium.launch(executable_path=CHROMIUM, args=OPTIONS)
        yield browser
        browser.close()


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Results of a soft box and a wedge that fall, the wedge turned by its velocity."""
    path = tmp_path_factory.mktemp("browser") / "fall.results"
    data = case(
        BLOCKS, {"box": {}, "chip": {"velocity": [3, 0, 0]}}, rock={"young_modulus": "1 MPa"},
        loads={"gravity": [0, 0, -10]}, output={"every": 0.05}, title="A <fall>",
        stages=[{"name": "fall", "mode": "dynamic", "duration": 0.2}],
        histories=[{"name": "chip", "group": "chip", "quantities": ["velocity"]}],
    )  # fmt: skip
    cdem.Simulation(data, threads=1, output=path).run()
    return path


def now(folder: Path, frame: int) -> str:
    """What the page says of the time of a frame."""
    return f"{cdem.open(folder).times[frame]:.3f} s"


class Page:
    """A page, what it asks for, and what goes wrong in it."""

    def __init__(self, browser, address: str, **options) -> None:
        self.context = browser.new_context(viewport={"width": 1000, "height": 700}, **options)
        self.page = self.context.new_page()
        self.asked, self.wrong = [], []
        self.page.on("request", lambda request: self.asked.append(request.url))
        self.page.on("pageerror", lambda error: self.wrong.append(str(error)))
        self.page.on("console", lambda message: self.wrong.append(message.text))
        self.page.goto(address)
        self.page.wait_for_selector("body[data-ready]")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.context.close()

    def set(self, name: str, value: str) -> None:
        """Give a control a value as a user would."""
        self.page.evaluate(
            "([id, v]) => { const e = document.getElementById(id); e.value = v;"
            "for (const n of ['input', 'change']) e.dispatchEvent(new Event(n)); }",
            [name, value],
        )

    def picture(self) -> bytes:
        """The pixels of the moving picture, once it is drawn; nothing else."""
        return self.page.evaluate(
            "() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame("
            "() => done(document.getElementById('gl').toDataURL()))))"
        )


def test_a_report_moves_and_asks_for_nothing(browser, folder):
    address = report(folder).resolve().as_uri()
    with Page(browser, address, offline=True) as page:
        shown = page.page.inner_text
        assert (shown("h1"), shown("#status")) == ("A <fall>", "finished")
        assert shown("#now") == now(folder, -1)
        end = page.picture()
        page.set("slider", "0")
        start = page.picture()
        page.set("slider", "1.5")
        between = page.picture()
        times = cdem.open(folder).times
        assert float(shown("#now").split()[0]) == pytest.approx(times[1:3].mean(), abs=1e-3)
        assert len({start, between, end}) == 3
        page.set("field", "group")
        assert page.picture() != between and "chip" in shown("#ticks")
        assert (page.asked, page.wrong) == ([address], [])


def test_each_control_changes_the_picture_and_back(browser, folder):
    with Page(browser, report(folder).resolve().as_uri(), offline=True) as page:
        before = page.picture()
        for change, back in (
            (lambda: page.set("least", "0.9"), lambda: page.set("least", "0")),
            (lambda: page.set("section", "2"), lambda: page.set("section", "")),
            (lambda: page.set("map", "magma"), lambda: page.set("map", "viridis")),
            *[(lambda n=n: page.page.click(n), lambda n=n: page.page.click(n))
              for n in ("#lines", "#start", "#groups input >> nth=0")],
        ):  # fmt: skip
            change()
            assert page.picture() != before
            back()
            assert page.picture() == before
        page.page.mouse.click(400, 350)
        page.page.focus("#gl")
        page.page.keyboard.press("Home")
        page.page.keyboard.press("ArrowRight")
        page.picture()
        assert page.page.inner_text("#now") == now(folder, 1)
        with page.page.expect_download() as saved:
            page.page.click("#save")
        assert (
            saved.value.suggested_filename == f"displacement-{now(folder, 1).replace(' ', '')}.png"
        )
        assert page.wrong == []


def test_a_block_that_is_clicked_says_what_it_is(browser, folder):
    with Page(browser, report(folder).resolve().as_uri(), offline=True) as page:
        page.page.click("[data-view=top]")
        size = page.page.eval_on_selector("#gl", "e => [e.clientWidth, e.clientHeight]")
        for k in range(2, 18):  # along the middle of the picture
            page.page.click("#gl", position={"x": size[0] * k / 20, "y": size[1] * 0.47})
            page.picture()
            told = page.page.inner_text("#picked")
            if "of box" in told:
                break
        assert told.startswith("block 0 of box\nat ")
        moved = float(told.split("displacement: ")[1].split(" mm")[0]) / 1000
        mean = cdem.open(folder).summary["groups"]["box"]["displacement"]
        assert moved == pytest.approx(-mean[2], rel=0.03)  # two digits
        assert page.wrong == []


def test_on_a_phone_legend_and_scale_lie_apart(browser, folder):
    address = report(folder).resolve().as_uri()
    with Page(browser, address, offline=True, color_scheme="dark") as page:
        page.page.set_viewport_size({"width": 390, "height": 800})
        legend, stage, bar = (
            page.page.locator(name).bounding_box() for name in ("#legend", "#stage", "#time")
        )
        assert legend["y"] + legend["height"] < stage["y"] + stage["height"] / 3
        assert bar["x"] >= 0 and bar["x"] + bar["width"] <= 390
        assert page.page.evaluate("document.documentElement.scrollWidth") == 390


def test_a_page_follows_a_run_that_goes_on(browser, folder, tmp_path):
    growing = tmp_path / "growing.results"

    def grow(first: int, last: int) -> None:
        for part in ("frames", "surface"):
            (growing / part).mkdir(parents=True, exist_ok=True)
            for path in sorted((folder / part).glob("frame-*"))[first:last]:
                shutil.copy(path, growing / part)

    shutil.copytree(folder, growing, ignore=shutil.ignore_patterns("frame-*", "summary.json"))
    grow(0, 2)
    with served(growing) as server, Page(browser, server.address) as page:
        assert page.page.inner_text("#now") == now(folder, 1)
        page.set("field", "velocity")
        before = page.picture()
        grow(2, 4)
        page.page.wait_for_selector("#slider[max='3']")
        assert page.picture() != before and page.page.inner_text("#now") == now(folder, 3)
        grow(4, len(cdem.open(folder)))
        shutil.copy(folder / "summary.json", growing)
        page.page.wait_for_selector("#status.good")
        assert page.page.input_value("#field") == "velocity"
        asked = [Path(url).name for url in page.asked if "data?" in url]
        assert [url.split("&")[0] for url in asked] == [f"data?frames={k}" for k in (0, 2, 4)]
        assert page.wrong == []
        wrong = server.address.replace(server.token, "x" * len(server.token))
        assert page.page.goto(wrong).status == 403


def test_what_a_notebook_shows_moves_too(browser, folder, tmp_path):
    (tmp_path / "cell.html").write_text(cdem.open(folder)._repr_html_())
    context = browser.new_context(viewport={"width": 1000, "height": 800}, offline=True)
    page = context.new_page()
    page.goto((tmp_path / "cell.html").as_uri())
    inside = page.frame_locator("iframe")
    inside.locator("body[data-ready]").wait_for()
    assert inside.locator("#now").inner_text() == now(folder, -1)
    context.close()
