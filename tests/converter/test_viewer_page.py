"""The page that plays plans: its text, and its behaviour in a browser."""

import json
import os
import re
import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Browser, Page, sync_playwright

from converter.animate_plan import FIRST_REST_S, LAST_REST_S, REST_S
from converter.plan import Plan, Status
from converter.scene import Scene
from converter.viewer_page import embedded_json, plan_payload, player_assets, viewer_page, write_viewer

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
EVIL = '</script><img src=x onerror="window.hacked=1"><!--<script>&\''
PLAYER = "document.getElementById('player').manipuzzlePlayer"

Value = Any
"""What comes out of a browser."""


def text_of(page: str) -> list[dict[str, Value]]:
    """The plans of a page as a browser would parse them."""
    (data,) = re.findall(r'<script type="application/json" id="plans">(.*?)</script>', page, re.DOTALL)
    return json.loads(data)


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """A headless browser of the system."""
    program = next((path for name in BROWSERS if (path := shutil.which(name))), None)
    if program is None:
        pytest.skip(f"no browser installed: none of {', '.join(BROWSERS)}")
    with sync_playwright() as playwright:
        options = ["--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"]
        started = playwright.chromium.launch(executable_path=program, args=options, env=dict(os.environ))
        yield started
        started.close()


class Viewer:
    """A page in a browser, and what it should never do."""

    def __init__(self, browser: Browser, file: Path, **options: Value) -> None:
        self.context = browser.new_context(**options)
        self.page: Page = self.context.new_page()
        self.complaints: list[str] = []
        self.requests: list[str] = []
        self.page.on("console", lambda message: self.complaints.append(message.text))
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.goto(file.as_uri())

    def player(self, expression: str) -> Value:
        """The value of `player.<expression>`."""
        return self.page.evaluate(f"() => {{ const value = {PLAYER}.{expression}; return value ?? null; }}")

    def wait_until(self, condition: str) -> None:
        """Asks the page until a condition holds; Playwright's own way needs `eval`, which the page forbids."""
        for _ in range(200):
            if self.page.evaluate(f"() => Boolean({condition})"):
                return
            self.page.wait_for_timeout(50)
        pytest.fail(f"never: {condition}")

    def agent(self, stage: int = 0) -> list[float]:
        """Where a stage shows its agent [m]."""
        transform = self.page.evaluate(f"{PLAYER}.stages[{stage}].agent.node.getAttribute('transform')")
        x, y = (float(number) for number in re.findall(r"-?\d[\d.]*(?:e-?\d+)?", transform))
        return [x, -y]

    def doing(self, stage: int = 0) -> str:
        """What a stage says is going on."""
        return self.page.locator(".mzp-now").nth(stage).inner_text()


@pytest.fixture
def viewer(browser: Browser, tmp_path: Path, small_room: Scene, small_plan: Plan) -> Iterator[Viewer]:
    """The page of one plan."""
    write_viewer(tmp_path / "plan.html", "room", [plan_payload(small_room, small_plan)])
    opened = Viewer(browser, tmp_path / "plan.html")
    yield opened
    assert opened.complaints == []
    opened.context.close()


def placements(plan: Plan) -> list[float]:
    """Times at which a plan puts objects down [s]."""
    time, found = FIRST_REST_S, []
    for segment in plan.segments:
        time += segment.length
        if segment.object is not None:
            found.append(time)
        time += REST_S
    return found


def test_payloads_are_plain_and_complete(small_room: Scene, small_plan: Plan):
    """JSON can hold them, and they have the whole motion and the numbers that captions show."""
    payload = json.loads(json.dumps(plan_payload(small_room, small_plan), allow_nan=False))
    assert [segment["carried"] for segment in payload["segments"]] == [None, 0, None, 0, None]
    assert np.allclose(payload["segments"][1]["path"], small_plan.segments[1].path)
    assert [(place["position"], place["numbers"]) for place in payload["placements"]] == [
        ([-1.2, 0.8], [1]),
        ([-1.0, 1.5], [2]),
    ]
    assert (payload["pick_places"], payload["path_length_m"]) == (2, pytest.approx(small_plan.path_length))
    assert [item["name"] for item in payload["objects"]] == ["obj", "obstacle"]


@pytest.mark.parametrize("text", [EVIL, "\u2028\u2029", "]]>", "Größe"])
def test_no_text_ends_the_data(text: str):
    """Whatever a name holds, JSON inside of a page stays inside, and comes back as it was."""
    embedded = embedded_json({"name": text})
    assert not re.search(r"[<>&\u2028\u2029]", embedded)
    assert json.loads(embedded) == {"name": text}


def test_a_page_is_complete_and_deterministic(small_room: Scene, small_plan: Plan):
    """It names nothing that would have to be loaded, and equal plans give equal bytes."""
    payload = plan_payload(small_room, small_plan)
    page, again = viewer_page("a < b", [payload]), viewer_page("a < b", [payload])
    assert page == again
    assert "<title>a &lt; b</title>" in page
    assert text_of(page) == json.loads(json.dumps([payload]))
    assert set(re.findall(r"https?://[^\"' ]+", page)) == {"http://www.w3.org/2000/svg"}
    assert not re.search(r"<link|@import|\burl\(|<script src", page)


def test_assets_can_stand_in_a_page():
    """Style and script do not end the elements that hold them."""
    assets = player_assets()
    assert "</" not in assets.style
    assert "</script" not in assets.script.lower()
    assert "<!--" not in assets.script


def test_a_page_begins_at_rest(viewer: Viewer, small_plan: Plan):
    """It shows the start, does not play by itself, lasts as long as the motion and its rests, and loads nothing."""
    length = FIRST_REST_S + small_plan.path_length + REST_S * 4 + LAST_REST_S
    assert viewer.player("duration") == pytest.approx(length)
    assert (viewer.player("playing"), viewer.player("time")) == (False, 0)
    assert viewer.agent() == [0.0, -1.0]
    assert viewer.doing() == "start · 0.0 m"
    assert [url for url in viewer.requests if not url.startswith("file:")] == []
    assert len(viewer.requests) == 1


def test_play_and_pause(viewer: Viewer):
    """The button starts and stops the clock, and says which it will do."""
    button = viewer.page.get_by_role("button", name="Play", exact=True)
    button.click()
    viewer.wait_until(f"{PLAYER}.time > 0.2")
    assert viewer.player("playing") is True
    viewer.page.get_by_role("button", name="Pause", exact=True).click()
    time = viewer.player("time")
    viewer.page.wait_for_timeout(100)
    assert (viewer.player("playing"), viewer.player("time")) == (False, time)
    assert viewer.page.get_by_role("button", name="Play", exact=True).count() == 1


def test_it_stops_at_the_end_and_starts_again(viewer: Viewer):
    """At the end it pauses; play then begins anew."""
    viewer.player("seek(1e9)")
    assert viewer.doing().startswith("done")
    assert viewer.agent() == [0.0, -1.0]
    viewer.player(f"seek({viewer.player('duration')} - 0.05)")
    viewer.player("play()")
    viewer.wait_until(f"!{PLAYER}.playing")
    assert viewer.player("time") == viewer.player("duration")
    viewer.player("play()")
    viewer.wait_until(f"{PLAYER}.playing && {PLAYER}.time < 5")


@pytest.mark.parametrize(
    ("time", "agent", "doing"),
    [
        (FIRST_REST_S + 0.5, [-0.5, -1.0], "step 1 of 5: driving to obj · 0.5 m"),
        (FIRST_REST_S + 1.3, [-1.0, -0.7], "step 1 of 5: driving to obj · 1.3 m"),
        (FIRST_REST_S + 1.6 + REST_S + 0.4, [-1.0970, -0.0119], "step 2 of 5: carrying obj · 2.0 m"),
        (FIRST_REST_S + 1.6 + REST_S + 0.9, [-1.2, 0.4], "step 2 of 5: placed obj · 2.4 m"),
    ],
)
def test_every_moment_is_right(viewer: Viewer, time: float, agent: list[float], doing: str):
    """The agent drives at 1 m/s along its path, and what it holds keeps its place beside it."""
    viewer.player(f"seek({time})")
    assert viewer.agent() == pytest.approx(agent, abs=1e-3)
    assert viewer.doing() == doing
    held = viewer.page.evaluate(f"{PLAYER}.timelines[0].at({time}).objects[0]")
    start = [-1.0, 0.0] if "driving" in doing else [agent[0], agent[1] + 0.4]
    assert held == pytest.approx(start, abs=1e-3)


def test_scrubbing_follows_the_slider(viewer: Viewer):
    """The slider moves the clock, and says where it is."""
    slider = viewer.page.get_by_role("slider", name="Time")
    slider.evaluate("(node) => { node.value = '2.5'; node.dispatchEvent(new Event('input')); }")
    assert viewer.player("time") == pytest.approx(2.5)
    assert (slider.get_attribute("aria-valuetext") or "").startswith("2.5 s of ")


def test_steps_go_from_subgoal_to_subgoal(viewer: Viewer, small_plan: Plan):
    """Forward through the placements to the end, back to the start; there it stays."""
    stops = [*placements(small_plan), viewer.player("duration")]
    for stop in [*stops, stops[-1]]:
        viewer.page.get_by_role("button", name="Next subgoal").click()
        assert viewer.player("time") == pytest.approx(stop)
    for stop in [*stops[-2::-1], 0, 0]:
        viewer.page.get_by_role("button", name="Previous subgoal").click()
        assert viewer.player("time") == pytest.approx(stop)


def test_keys_do_what_the_help_says(viewer: Viewer, small_plan: Plan):
    """Without a click first; keys with a modifier are left to the browser."""
    press = viewer.page.keyboard.press
    press("End")
    assert viewer.player("time") == viewer.player("duration")
    press("Home")
    press("ArrowRight")
    press("ArrowRight")
    press("ArrowLeft")
    assert viewer.player("time") == pytest.approx(0.5)
    press("Shift+ArrowRight")
    assert viewer.player("time") == pytest.approx(placements(small_plan)[0])
    press("+")
    press("+")
    press("-")
    assert viewer.player("speed") == 2
    press("p")
    press("s")
    assert not viewer.page.locator(".mzp-paths").is_visible()
    assert not viewer.page.locator(".mzp-subgoals").is_visible()
    press("Control+p")
    press(" ")
    assert viewer.player("playing") is True
    press(" ")
    assert viewer.player("playing") is False


def test_space_on_a_button_presses_it_once(viewer: Viewer):
    """A focused button is not pressed twice, by the browser and by the shortcut."""
    viewer.page.get_by_role("button", name="Play", exact=True).focus()
    viewer.page.keyboard.press(" ")
    assert viewer.player("playing") is True


def test_options_hide_path_and_subgoals(viewer: Viewer):
    """Both are shown at first; each box hides its own."""
    for label, shown in (("Show path", ".mzp-paths"), ("Show subgoals", ".mzp-subgoals")):
        assert viewer.page.locator(shown).is_visible()
        viewer.page.get_by_label(label).uncheck()
        assert not viewer.page.locator(shown).is_visible()
    viewer.page.get_by_label("Speed").select_option("4")
    assert viewer.player("speed") == 4


def test_several_plans_share_one_clock(browser: Browser, tmp_path: Path, small_room: Scene, small_plan: Plan):
    """Side by side; the shorter one waits at its end. A failed plan shows the scene and says so."""
    short = replace(small_plan, method="short", segments=small_plan.segments[:2])
    failed = replace(small_plan, method="failed", status=Status.TIMEOUT, segments=())
    write_viewer(tmp_path / "a.html", "room", [plan_payload(small_room, plan) for plan in (small_plan, short, failed)])
    viewer = Viewer(browser, tmp_path / "a.html", viewport={"width": 1400, "height": 800})
    assert viewer.player("duration") == viewer.player("timelines[0].duration")
    viewer.player("seek(2)")
    assert viewer.agent(0) == viewer.agent(1) != viewer.agent(2)
    viewer.player("seek(1e9)")
    assert np.allclose(viewer.agent(1), [-1.2, 0.4])
    assert viewer.doing(2) == "no motion: timeout · 0.0 m"
    boxes = [viewer.page.locator(".mzp-stage").nth(i).bounding_box() for i in range(3)]
    assert len({round(box["y"]) for box in boxes if box}) == 1
    assert viewer.complaints == []


def test_names_are_inert(browser: Browser, tmp_path: Path, small_room: Scene, small_plan: Plan):
    """Markup in the names of scene, method and objects is shown as text and does nothing."""
    obj, obstacle = small_room.objects
    scene = replace(
        small_room, name=EVIL, objects=(replace(obj, name=EVIL), obstacle), goal=replace(small_room.goal, object=EVIL)
    )
    segments = tuple(replace(s, object=None if s.object is None else EVIL) for s in small_plan.segments)
    write_viewer(tmp_path / "a.html", EVIL, [plan_payload(scene, replace(small_plan, method=EVIL, segments=segments))])
    viewer = Viewer(browser, tmp_path / "a.html")
    viewer.player("seek(3)")
    assert EVIL in viewer.doing()
    assert viewer.page.evaluate("window.hacked ?? null") is None
    assert viewer.page.locator("img").count() == 0
    assert viewer.page.locator("h1").inner_text() == EVIL
    assert viewer.complaints == []
    assert len(viewer.requests) == 1


def test_it_fits_a_phone(browser: Browser, tmp_path: Path, small_room: Scene, small_plan: Plan):
    """On a narrow screen nothing needs scrolling sideways, and buttons are large enough for fingers."""
    write_viewer(tmp_path / "a.html", "room", [plan_payload(small_room, small_plan)] * 2)
    viewer = Viewer(browser, tmp_path / "a.html", viewport={"width": 360, "height": 640}, has_touch=True)
    assert viewer.page.evaluate("document.documentElement.scrollWidth") <= 360
    viewer.page.get_by_role("button", name="Play", exact=True).tap()
    viewer.wait_until(f"{PLAYER}.time > 0")
    box = viewer.page.get_by_role("button", name="Pause", exact=True).bounding_box()
    assert box is not None
    assert min(box["width"], box["height"]) >= 44


def test_a_player_can_be_mounted_and_removed(viewer: Viewer):
    """Other pages mount it where they like; its keys work only inside of it, and nothing of it stays."""
    viewer.page.evaluate(
        "() => { const div = document.createElement('div'); div.id = 'other'; document.body.append(div);"
        " window.other = ManipuzzlePlayer.mount(div, JSON.parse(document.getElementById('plans').textContent)[0]); }"
    )
    assert viewer.page.evaluate("window.other.duration") == viewer.player("duration")
    viewer.page.locator("#other").focus()
    viewer.page.keyboard.press("End")
    assert viewer.page.evaluate("window.other.time === window.other.duration") is True
    viewer.page.evaluate("window.other.destroy()")
    assert viewer.page.locator("#other > *").count() == 0
