"""The HTML report of `msbvh accuracy`: in a real browser, with every kind of figure, and with hardly any."""

from __future__ import annotations

import json
import math
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import accuracy_data
import browser as browsers
import pytest
from browser import Browser, find_browser
from msbvh.accuracy_report.report import write_report
from msbvh.base.errors import SceneError

PHONE, DESKTOP = (375, 760), (1280, 900)
SMALLEST_TEXT = 11.0
"""CSS pixels, in plots and tables on a phone."""
LEAST_CONTRAST = 4.5
"""Of text: WCAG 2.2, 1.4.3."""


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("report")
    return write_report(accuracy_data.accuracy_data(folder), folder)


@pytest.fixture(scope="module")
def session(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    with Browser(find_browser(), tmp_path_factory.mktemp("profile")) as running:
        yield running


@pytest.fixture
def page(session: Browser, report: Path) -> Browser:
    """The report on a desktop."""
    show(session, report, DESKTOP)
    return session


def show(browser: Browser, path: Path, size: tuple[int, int], dark: bool = False) -> None:
    browser.events.clear()
    browser.resize(*size, dark)
    browser.open(path)


def box(browser: Browser, selector: str) -> dict[str, float]:
    """Of an element, in the window's pixels, after scrolling to it."""
    script = f"""(() => {{
      const element = document.querySelector({json.dumps(selector)});
      element.scrollIntoView({{block: "center", behavior: "instant"}});
      const {{x, y, width, height}} = element.getBoundingClientRect();
      return {{x, y, width, height}};
    }})()"""
    return browser.run(script)


def center(browser: Browser, selector: str) -> tuple[float, float]:
    found = box(browser, selector)
    return found["x"] + found["width"] / 2, found["y"] + found["height"] / 2


# The file -------------------------------------------------------------------------------------------------------------


def test_the_report_is_one_file(report: Path) -> None:
    text = report.read_text(encoding="utf-8")
    assert report.name == "report.html"
    assert set(re.findall(r'(?:href|src)="(?!#|data:)([^"]*)"', text)) == set()
    assert "@import" not in text and not re.search(r"url\((?!#)", text)


def test_the_same_figures_make_the_same_page(report: Path) -> None:
    before = report.read_bytes()
    write_report(accuracy_data.accuracy_data(report.parent), report.parent)
    assert report.read_bytes() == before


def test_every_figure_and_command_is_there(report: Path) -> None:
    text = report.read_text(encoding="utf-8")
    data = accuracy_data.accuracy_data(report.parent)
    for key in data["front"]:
        assert f"<code>{data['points'][key]['command']}</code>" in text
    for sentence in (*data["findings"], *data["warnings"]):
        assert sentence.replace("'", "&#39;") in text
    for expected in (
        "Failed: out of memory: 3.1 GB",
        "Left out: nothing in this scene is displaced",
        "1.04 times",
        "123 s",
    ):
        assert expected in text


@pytest.mark.parametrize("library", ["matplotlib", "jinja2"])
def test_a_missing_library_is_one_line(library: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in [name for name in sys.modules if name.startswith(("msbvh.accuracy_report.", library))]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(SceneError) as caught:
        write_report({}, tmp_path)
    assert (
        str(caught.value) == f"the HTML report needs {library}, which is not installed: pip install 'msbvh[accuracy]'"
    )
    assert list(tmp_path.iterdir()) == []


# In the browser -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("size", [PHONE, DESKTOP])
def test_no_fault_and_no_request(session: Browser, report: Path, size: tuple[int, int]) -> None:
    show(session, report, size)
    assert session.faults() == []
    others = [url for url in session.requests() if not url.startswith("data:")]
    assert others == [report.as_uri()]


PLOTS = """[...document.querySelectorAll("figure.plots")].map(figure => {
  const shown = [...figure.querySelectorAll("svg")].filter(svg => svg.getBoundingClientRect().width > 0);
  return shown.map(svg => {
    const scale = svg.getBoundingClientRect().width / svg.viewBox.baseVal.width;
    const boxes = [...svg.querySelectorAll("path, use")].map(path => path.getBoundingClientRect());
    const texts = [...svg.querySelectorAll("text")];
    return {
      label: figure.getAttribute("aria-label"),
      height: svg.getBoundingClientRect().height,
      drawn: boxes.filter(box => box.width + box.height > 1).length,
      wide: Math.max(...boxes.map(box => box.right)) - Math.min(...boxes.map(box => box.left)),
      text: Math.min(...texts.map(text => scale * parseFloat(getComputedStyle(text).fontSize))),
      right: Math.max(...texts.map(text => text.getBoundingClientRect().right)),
    };
  });
})"""


@pytest.mark.parametrize("size", [PHONE, DESKTOP])
def test_every_plot_is_drawn(session: Browser, report: Path, size: tuple[int, int]) -> None:
    show(session, report, size)
    plots = session.run(PLOTS)
    assert len(plots) == 2 + 5  # The front, the stages, and each axis that is not left out.
    for shown in plots:
        assert len(shown) == 1, "one of the two drawings is shown"
        assert shown[0]["height"] > 100 and shown[0]["drawn"] > 10, shown
        assert shown[0]["wide"] > 0.7 * min(size[0], 760), shown
        assert shown[0]["text"] >= SMALLEST_TEXT, shown
        assert shown[0]["right"] <= size[0], shown


@pytest.mark.parametrize("size", [PHONE, DESKTOP])
def test_labels_of_the_front_do_not_overlap(session: Browser, report: Path, size: tuple[int, int]) -> None:
    show(session, report, size)
    labels = session.run(
        """[...document.querySelectorAll("#front .label text")].map(text => text.getBoundingClientRect())
           .filter(box => box.width > 0).map(box => [box.left, box.top + 2, box.right, box.bottom - 2])"""
    )
    assert len(labels) == 3
    for i, (left, top, right, bottom) in enumerate(labels):
        for other in labels[:i]:
            assert right <= other[0] or other[2] <= left or bottom <= other[1] or other[3] <= top


def test_a_phone_scrolls_one_way(session: Browser, report: Path) -> None:
    show(session, report, PHONE)
    assert session.run("document.scrollingElement.scrollWidth") <= PHONE[0]
    assert session.run("innerWidth") == PHONE[0]
    texts = session.run(
        """[...document.querySelectorAll("main *")].filter(e => [...e.childNodes].some(n => n.nodeType === 3 && n.data.trim()))
           .filter(e => !e.closest("svg, script, noscript")).map(e => parseFloat(getComputedStyle(e).fontSize))"""
    )
    assert len(texts) > 200 and min(texts) >= SMALLEST_TEXT
    assert session.run("parseFloat(getComputedStyle(document.querySelector('main p:not(.over)')).fontSize)") >= 16


CONTRASTS = """(() => {
  const parts = color => (color.match(/[\\d.]+/g) || []).map(Number);
  const light = color => parts(color).slice(0, 3).map(c => c / 255)
    .map(c => c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4)
    .reduce((sum, c, i) => sum + c * [0.2126, 0.7152, 0.0722][i], 0);
  const behind = e => { for (; e; e = e.parentElement) { const c = getComputedStyle(e).backgroundColor;
    if (parts(c).length === 3) return c; } return "rgb(255, 255, 255)"; };
  const texts = [...document.querySelectorAll("body *")].filter(e => e.getBoundingClientRect().width > 0
    && !e.closest(".unseen, select") && [...e.childNodes].some(n => n.nodeType === 3 && n.data.trim()));
  return texts.map(e => {
    const style = getComputedStyle(e);
    const [a, b] = [light(e instanceof SVGElement ? style.fill : style.color), light(behind(e))];
    return [(Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05), e.textContent.trim().slice(0, 40)];
  }).sort((a, b) => a[0] - b[0]);
})()"""


@pytest.mark.parametrize("dark", [False, True])
def test_text_is_readable_in_both_schemes(session: Browser, report: Path, dark: bool) -> None:
    show(session, report, DESKTOP, dark)
    paper = session.run("getComputedStyle(document.body).backgroundColor")
    assert (sum(map(int, re.findall(r"\d+", paper))) < 200) == dark
    contrasts = session.run(CONTRASTS)
    assert len(contrasts) > 400
    assert contrasts[0][0] >= LEAST_CONTRAST, contrasts[:5]


SPLIT = """(() => {
  const style = getComputedStyle(document.getElementById("left-picture"));
  return [Number(document.getElementById("split").value), style.clipPath];
})()"""


def test_the_slider_moves_by_keys(page: Browser) -> None:
    center(page, "#slider")
    page.run("document.getElementById('split').focus()")
    value, clip = page.run(SPLIT)
    assert value == 50
    for _ in range(3):
        page.press("ArrowRight")
    moved, moved_clip = page.run(SPLIT)
    assert moved == 53 and moved_clip != clip
    page.press("ArrowLeft")
    assert page.run(SPLIT)[0] == 52
    assert page.run("document.getElementById('split').getAttribute('aria-label')")


def test_the_slider_moves_by_the_mouse(page: Browser, tmp_path: Path) -> None:
    slider = box(page, "#slider")
    y = slider["y"] + 0.4 * slider["height"]
    _, clip = page.run(SPLIT)
    page.mouse("Pressed", slider["x"] + 0.5 * slider["width"], y)
    for share in (0.4, 0.3, 0.2):
        page.mouse("Moved", slider["x"] + share * slider["width"], y)
    page.mouse("Released", slider["x"] + 0.2 * slider["width"], y)
    value, moved_clip = page.run(SPLIT)
    assert 19 <= value <= 21, "the line stands where the mouse let go"
    assert moved_clip != clip
    assert f"{100 - value}%" in moved_clip


def test_pictures_are_chosen(page: Browser) -> None:
    state = """({left: document.getElementById("left-picture").src, right: document.getElementById("right-picture").src,
      map: document.getElementById("error-map").src, hidden: document.getElementById("error-map").hidden,
      natural: document.getElementById("left-picture").naturalWidth,
      options: [...document.getElementById("left").options].map(o => o.label)})"""
    before = page.run(state)
    assert before["options"][0] == "Reference" and len(before["options"]) == len(set(before["options"]))
    assert {"2 keys everywhere", "Arnold-like 3 keys", "msbvh's own choice"} < set(before["options"])
    assert any(label.startswith("Front, ") for label in before["options"])
    assert before["left"] != before["right"] and before["map"] and not before["hidden"]
    assert before["natural"] == accuracy_data.WIDTH
    page.run("document.getElementById('left').focus()")
    choose = "(s => {{ s.value = {}; s.dispatchEvent(new Event('change')); }})(document.getElementById('left'))"
    page.run(choose.format(2))
    after = page.run(state)
    assert after["left"] != before["left"] and after["map"] != before["map"] and after["right"] == before["right"]
    page.run(choose.format(0))
    assert page.run(state)["hidden"], "the reference has no error map"


HEADS = "[...document.querySelectorAll('table.sorts thead th')].map(th => th.getAttribute('aria-sort'))"


def column(browser: Browser, index: int) -> list[str]:
    return browser.run(f"[...document.querySelectorAll('table.sorts tbody tr')].map(r => r.cells[{index}].innerText)")


def test_prims_are_sorted_by_keys(page: Browser) -> None:
    page.run("document.querySelectorAll('table.sorts thead button')[2].focus()")
    page.press("Enter")
    assert page.run(HEADS)[2] == "descending"
    assert column(page, 2) == ["0.0900", "0.0710", "0.0400", "0", "–"]
    page.press(" ")
    assert page.run(HEADS)[2] == "ascending"
    assert column(page, 2) == ["0", "0.0400", "0.0710", "0.0900", "–"], "what is missing stays last"


def test_prims_are_sorted_by_the_mouse(page: Browser) -> None:
    for selector in ("thead th:nth-child(3) button", "thead th:nth-child(1) button"):
        page.click(*center(page, f"table.sorts {selector}"))
    assert [order for order in page.run(HEADS) if order] == ["ascending"]
    paths = column(page, 0)
    assert paths == sorted(paths) and len(paths) == 5


def test_a_command_is_copied(page: Browser) -> None:
    page("Browser.grantPermissions", permissions=["clipboardReadWrite", "clipboardSanitizedWrite"])
    page.click(*center(page, "#front tbody button.copy"))
    page.run("new Promise(done => setTimeout(done, 100))")
    assert page.run("document.querySelector('#front tbody button.copy').innerText") == "Copied"
    copied = page.run("navigator.clipboard.readText()")
    assert copied == page.run("document.querySelector('#front tbody code').textContent")


# What a report may lack -----------------------------------------------------------------------------------------------


def hostile() -> dict[str, Any]:
    """Everything that JSON can hold in the place of a figure, and names that are markup."""
    strange = [0.0, -1.0, math.nan, math.inf, None, 1e-300, 1e300]
    points: dict[str, Any] = {
        f"p{i}": {
            "options": {"<b>x</b>": value, "on": True},
            "seconds": {"frame": [value, value, strange[i - 1]], "trace": [value], "read": None},
            **dict.fromkeys(("relative_mse", "motion_px", "flip", "peak_bytes", "rays", "nodes_per_ray"), value),
        }
        for i, value in enumerate(strange)
    }
    points |= {"empty": {}, "none": None, "failed": {"failed": "<i>no</i>", "seconds": None}}
    steps = [{"value": "$x^2$", "id": key} for key in (*points, "unknown")]
    series = [{"name": "</script><script>throw 1</script>", "points": steps}, {"name": "_", "points": []}, {}]
    errors = ("motion", "shape", "noise", "light", "none", "other", None)
    axes: list[dict[str, Any]] = [
        {"name": "$a$ & <b>", "option": "o", "error": error, "series": series} for error in errors
    ]
    axes += [{}, {"error": "none", "series": []}, {"series": [{"points": [{"id": "unknown"}]}]}]
    prim = {"path": "/<b>", "error_px": math.nan, "cheaper": {}, "finer": {"error_px": math.inf, "frame_share": None}}
    return {
        "scene": "</title><script>throw 2</script>.usda",
        "points": points,
        "axes": axes,
        "named": [{"name": "</script>", "id": key} for key in (*points, "unknown", None)],
        "front": [*points, "unknown"],
        "targets": [{"asked": "<b>", "holds": None, "id": "unknown"}, {}],
        "prims": [prim, {}, *({"path": f"/p{i}", "error_px": float(i)} for i in range(700))],
        "findings": ["<script>throw 3</script>"],
        "reference": {"picture": "pictures/absent.png"},
    }


def sparse() -> dict[str, dict[str, Any]]:
    lists: dict[str, Any] = {key: [] for key in ("axes", "named", "front", "targets", "prims", "findings", "warnings")}
    nulls = dict.fromkeys(("scene", "frame", "camera", "resolution", "machine", "base", "reference", *lists, "points"))
    one = {"points": {"a": {"seconds": {"frame": [1.0, 1.0, 1.0]}, "relative_mse": 0.0}}, "front": ["a"]}
    return {"nothing": {}, "lists": {**lists, "points": {}}, "nulls": nulls, "zero": one, "hostile": hostile()}


@pytest.mark.parametrize("kind", list(sparse()))
def test_nothing_is_needed(kind: str, tmp_path: Path, session: Browser) -> None:
    path = write_report(sparse()[kind], tmp_path)
    show(session, path, PHONE)
    assert session.faults() == []
    assert [url for url in session.requests() if not url.startswith("data:")] == [path.as_uri()]
    assert session.run("document.scrollingElement.scrollWidth") <= PHONE[0]
    assert session.run("document.querySelectorAll('main > section, main > header').length") == 9
    text = session.run("document.querySelector('main').innerText")
    assert not re.search(r"\b(nan|None|undefined|Undefined|null)\b", text)


def test_many_prims_are_cut_and_absent_pictures_named(tmp_path: Path) -> None:
    text = write_report(hostile(), tmp_path).read_text(encoding="utf-8")
    assert "500 of 702 prims that are furthest" in " ".join(text.split())
    assert "/p699<" in text and "/p199<" not in text
    assert "pictures/absent.png: no PNG file was found there" in text
    assert "<script>throw" not in text and "<i>no</i>" not in text


def test_an_absent_browser_is_said(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setenv("MSBVH_REQUIRE_BROWSER", "1")
    with pytest.raises(pytest.fail.Exception, match="expected Debian's package chromium"):
        browsers.find_browser()
    monkeypatch.setenv("MSBVH_REQUIRE_BROWSER", "0")
    with pytest.raises(pytest.skip.Exception, match="no Chromium on this machine"):
        browsers.find_browser()
