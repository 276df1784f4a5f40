"""The page of a run in a browser: it asks for nothing, moves, and follows a run that goes on."""

from __future__ import annotations

import os
import re
import shutil
from functools import partial
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
    return f"{cdem.open(folder).times[frame]:.3f}"


class Page:
    """A page, what it asks for, and what goes wrong in it."""

    def __init__(self, browser, address: str, **options) -> None:
        size = {"viewport": {"width": 1000, "height": 700}}
        self.context = browser.new_context(**size | options)
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

    def time(self) -> str:
        """The time that the page says."""
        return self.page.input_value("#now")

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
        assert page.time() == now(folder, -1)
        end = page.picture()
        page.set("slider", "0")
        start = page.picture()
        page.set("slider", "1.5")
        between = page.picture()
        times = cdem.open(folder).times
        assert float(page.time()) == pytest.approx(times[1:3].mean(), abs=1e-3)
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
        assert page.time() == now(folder, 1)
        with page.page.expect_download() as saved:
            page.page.click("#save")
        assert saved.value.suggested_filename == f"displacement-{now(folder, 1)}s.png"
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


def test_colours_have_the_typed_range_and_a_logarithmic_scale(browser, folder):
    with Page(browser, report(folder).resolve().as_uri(), offline=True) as page:
        ticks = partial(page.page.inner_text, "#ticks")
        automatic, told, most = (
            page.picture(),
            ticks(),
            page.page.get_attribute("#high", "placeholder"),
        )
        assert page.page.is_disabled("#automatic")
        page.set(
            "high", f"{float(most) / 2:g}".replace(".", ",")
        )  # a comma, as many people type it
        half, shown = page.picture(), ticks()
        assert half != automatic and shown != told
        page.set("low", most)  # above the other end: it is marked, and changes nothing
        assert page.page.get_attribute("#low", "aria-invalid") == "true"
        assert (page.picture(), ticks()) == (half, shown)
        page.page.click("#automatic")
        assert (page.picture(), ticks(), page.page.input_value("#high")) == (automatic, told, "")
        page.page.check("#logarithmic")
        place = "e => [...e.children].map((t) => [Number(t.innerText), parseFloat(t.style.left)])"
        (a, at), (b, bt), (c, ct) = page.page.eval_on_selector("#ticks", place)[-3:]
        assert b / a == pytest.approx(c / b) and bt - at == pytest.approx(ct - bt)
        assert page.picture() != automatic and ", log" in page.page.inner_text("#legend-name")
        page.set("field", "velocity")  # each field has its own
        assert not page.page.is_checked("#logarithmic")
        page.set("field", "displacement")
        page.page.uncheck("#logarithmic")
        assert page.picture() == automatic and page.wrong == []


def test_a_typed_time_goes_to_the_next_frame(browser, folder):
    times = cdem.open(folder).times
    with Page(browser, report(folder).resolve().as_uri(), offline=True) as page:
        for typed, frame in (
            (f"{0.6 * times[1] + 0.4 * times[2]:.4f}", 1), ("0,16 s", 3), ("99", -1), ("soon", -1),
        ):  # fmt: skip
            page.page.fill("#now", typed)
            page.page.press("#now", "Enter")
            page.picture()
            assert page.time() == now(folder, frame)
        assert page.wrong == []


def test_fixed_rock_is_grey_without_edges_until_asked(browser, tmp_path):
    data = case(BLOCKS, {"box": {"fix": ["x", "y", "z"]}, "chip": {}}, rock={"young_modulus": "1 MPa"},
                loads={"gravity": [0, 0, -10]}, crs="EPSG:32632",
                stages=[{"name": "fall", "mode": "dynamic", "duration": 0.02}])  # fmt: skip
    cdem.Simulation(data, threads=1, output=tmp_path / "r").run()
    with Page(browser, report(tmp_path / "r").resolve().as_uri(), offline=True) as page:
        page.page.click("#groups input >> nth=1")  # only the fixed box is left
        page.page.uncheck("#lines")
        plain = page.picture()
        for name in ("velocity", "block"):
            page.set("field", name)
            assert page.picture() == plain
        page.page.check("#fixed-lines")
        assert page.picture() != plain
        page.page.uncheck("#fixed-lines")
        page.set("field", "group")
        assert page.picture() != plain and page.wrong == []


def test_a_map_has_a_north_arrow_in_place_of_axes(browser, folder, tmp_path):
    shutil.copytree(folder, tmp_path / "map")
    with (tmp_path / "map/case.yaml").open("a") as file:
        file.write("crs: EPSG:32632\n")
    red = """() => { const c = document.getElementById("hud"), d = c.getContext("2d");
        const p = d.getImageData(c.width - 116, 0, 116, 116).data, of = [0, 0];
        for (let k = 0; k < p.length; k += 4)
          if (p[k + 3] > 200) of[p[k] > p[k + 1] + 60 && p[k] > p[k + 2] + 60 ? 0 : 1] += 1;
        return of; }"""
    drawn = []
    for path in (folder, tmp_path / "map"):
        with Page(browser, report(path).resolve().as_uri(), offline=True) as page:
            page.picture()
            drawn.append(page.page.evaluate(red))
            assert page.wrong == []
    assert drawn[0][0] > 20 and drawn[1][0] == 0 and drawn[1][1] > 100  # x is red, no part of N is


def test_a_page_says_that_it_loads(browser, folder):
    with served(folder) as server:
        page = browser.new_page()
        held = []
        page.route("**/data?*", lambda route: held.append(route))
        page.goto(server.address)
        page.wait_for_selector("#loading:visible")
        held[0].continue_()
        page.wait_for_selector("body[data-ready]")
        assert not page.is_visible("#loading")
        page.close()


def test_a_phone_shows_all_of_the_page_and_its_tables(browser, folder):
    address = report(folder).resolve().as_uri()
    size = {"width": 390, "height": 844}
    for look in ("light", "dark"):
        with Page(browser, address, offline=True, color_scheme=look, viewport=size) as page:
            wide = (
                "e => [document.documentElement, ...document.querySelectorAll('.card, #controls')]"
            )
            wide += ".map((part) => part.scrollWidth - part.clientWidth)"
            assert not any(page.page.evaluate(wide))
            seen = "e => { const b = getComputedStyle(document.body); return [b.color, b.backgroundColor]; }"
            ink, paper = (
                sum(map(int, re.findall(r"\d+", text)[:3])) for text in page.page.evaluate(seen)
            )
            assert abs(ink - paper) > 500 and (ink > paper) == (look == "dark")


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
        assert page.time() == now(folder, 1)
        page.set("field", "velocity")
        before = page.picture()
        grow(2, 4)
        page.page.wait_for_selector("#slider[max='3']")
        assert page.picture() != before and page.time() == now(folder, 3)
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
    assert inside.locator("#now").input_value() == now(folder, -1)
    context.close()
