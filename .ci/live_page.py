"""Drives the page of `velour live`: a picture, an edit, a slider, a pixel, verify, an error. Called by .ci/live."""

import atexit
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

from playwright.sync_api import expect, sync_playwright

velour, browser, shots = sys.argv[1:4]
root = pathlib.Path(__file__).resolve().parent.parent
SHADER = """surface silk(
    color base = color(0.1, 0.2, 0.5) [[ string help = "color of the diffuse base", string page = "Base" ]],
    color tint = 0.9 [[ string help = "color of the sheen", string page = "Sheen" ]],
    float roughness = 0.3 [[ string label = "Roughness", string help = "width of the sheen", float min = 0.01, float max = 1, string page = "Sheen" ]],
    string method = "exact" [[ string widget = "popup", string options = "exact|published|ashikhmin", string page = "Sheen" ]],
    int checked = 0 [[ string widget = "checkBox", string help = "squares of half the color", string page = "Pattern" ]],
    int squares = 8 [[ int min = 1, int max = 40, string page = "Pattern" ]])
{
    color c = base;
    if (checked != 0 && mod(floor(squares * 2 * u) + floor(squares * v), 2) == 0)
        c *= 0.5;
    Ci = c * diffuse(N);
    Ci = sheen(Ci, N, tint, roughness, "shadowing", method);
}
"""


def step(text):
    print(f"{time.monotonic() - begin:6.2f} s  {text}", flush=True)


class Page:
    """The page of a running `velour live`."""

    def __init__(self, context, folder, file):
        self.process = subprocess.Popen([velour, "live", file, "--port", "0"], cwd=folder, stdout=subprocess.PIPE, text=True)
        # It ends with this script, however that ends.
        atexit.register(self.process.kill)
        self.address = re.match(r"http://127\.0\.0\.1:\d+/", self.process.stdout.readline())[0]
        self.page = context.new_page()
        self.said = []
        self.page.on("console", lambda message: self.said.append(f"{message.type}: {message.text}"))
        self.page.on("pageerror", lambda error: self.said.append(f"error: {error}"))
        self.asked = []
        self.page.on("request", lambda request: self.asked.append(request.url))
        self.page.goto(self.address)

    def change(self):
        return int(self.page.locator("#picture").get_attribute("data-change") or 0)

    def samples(self):
        return int(self.page.locator("#picture").get_attribute("data-samples") or 0)

    def mean(self):
        """The mean color of the picture."""
        return self.page.evaluate(
            """() => { const c = document.getElementById("picture"); const d = c.getContext("2d").getImageData(0, 0, c.width, c.height).data;
            const s = [0, 0, 0]; for (let i = 0; i < d.length; i += 4) for (let k = 0; k < 3; k++) s[k] += d[i + k];
            return s.map((x) => x / (d.length / 4)); }"""
        )

    def after(self, act):
        """Does something, and waits for the picture that comes of it."""
        before = self.change()
        act()
        self.until("another picture", lambda: self.change() > before)

    def until(self, what, right):
        """Waits in the way that the page's policy allows: the script's own waiting would evaluate text in it."""
        deadline = time.monotonic() + 20
        while not right():
            assert time.monotonic() < deadline, what
            self.page.wait_for_timeout(30)

    def shot(self, name):
        self.page.screenshot(path=f"{shots}/{name}.png")

    def close(self):
        start = time.monotonic()
        self.process.send_signal(signal.SIGINT)
        status = self.process.wait(timeout=10)
        assert status == 130 and time.monotonic() - start < 1, (status, time.monotonic() - start)
        others = [url for url in self.asked if not url.startswith(self.address)]
        assert not others, others
        # That velour has gone is all there may be to complain about, and how this script reads pixels.
        wrong = [text for text in self.said if not re.search(r"ERR_(CONNECTION|INCOMPLETE|EMPTY)|willReadFrequently", text)]
        assert not wrong, wrong
        self.page.close()


def shader(context, folder):
    (folder / "silk.osl").write_text(SHADER)
    live = Page(context, folder, "silk.osl")
    page = live.page
    live.until("a picture", lambda: live.samples() >= 1)
    step("a picture")
    expect(page.locator("#controls .label").first).to_have_text("base")
    expect(page.locator("#controls")).to_contain_text("width of the sheen")

    before = live.mean()
    live.after(lambda: (folder / "silk.osl").write_text(SHADER.replace("0.1, 0.2, 0.5", "0.6, 0.1, 0.1")))
    page.wait_for_timeout(600)
    after = live.mean()
    assert after[0] > before[0] + 3 and after[2] < before[2] - 3, (before, after)
    step("an edit of the file is seen")

    slider = page.locator("input[type=range][data-name=roughness]")
    box = slider.bounding_box()
    page.mouse.move(box["x"] + 0.3 * box["width"], box["y"] + box["height"] / 2)
    page.mouse.down()
    live.after(lambda: page.mouse.move(box["x"] + 0.85 * box["width"], box["y"] + box["height"] / 2, steps=12))
    page.mouse.up()
    expect(page.locator("#written")).to_contain_text("float roughness 0.8")
    step("a slider is seen")
    live.after(lambda: page.locator("input[type=checkbox][aria-label=checked]").check())
    live.after(lambda: page.locator("select[aria-label=method]").select_option("published"))
    live.after(lambda: page.locator("input[type=color][aria-label=tint]").fill("#ffd9a0"))
    expect(page.locator("#written")).to_contain_text('string method "published"')
    step("a box, a menu and a well are seen")

    picture = page.locator("#picture").bounding_box()
    page.mouse.move(picture["x"] + 0.3 * picture["width"], picture["y"] + 0.55 * picture["height"])
    expect(page.locator("#tree")).to_contain_text("sheen (", timeout=10000)
    expect(page.locator("#lobes")).to_contain_text("diffuse")
    expect(page.locator("#where")).to_contain_text("silk")
    page.wait_for_timeout(1500)
    live.shot("pixel")
    step("the tree and the lobes of a pixel")

    page.locator("#tab-verify").click()
    page.locator("#run").click()
    expect(page.locator("#findings")).to_contain_text("energy", timeout=60000)
    expect(page.locator("#verdict")).to_contain_text("nothing fails")
    live.shot("verify")
    step("the table of verify")

    page.locator("#tab-pixel").click()
    (folder / "silk.osl").write_text(SHADER.replace("sheen(Ci, N,", "sheen(Ci, M,"))
    expect(page.locator("#trouble")).to_contain_text("^", timeout=10000)
    expect(page.locator("#trouble")).to_contain_text("silk.osl:13:")
    expect(page.locator("#stale")).to_be_visible()
    live.shot("error")
    step("a mistake with its place")
    live.after(lambda: (folder / "silk.osl").write_text(SHADER))
    expect(page.locator("#trouble")).to_be_hidden()
    live.close()
    step("Ctrl-C")


def scene(context, folder):
    shutil.copytree(root / "shaders", folder / "shaders")
    live = Page(context, folder, "shaders/scenes/figure1.xml")
    page = live.page
    live.until("some samples", lambda: live.samples() >= 4)
    picture = page.locator("#picture").bounding_box()
    page.mouse.click(picture["x"] + 0.5 * picture["width"], picture["y"] + 0.5 * picture["height"])
    expect(page.locator("#group option:checked")).to_have_text("cloth 3", timeout=10000)
    page.wait_for_timeout(1500)
    live.shot("scene")
    page.keyboard.press("Escape")
    live.close()
    step("a scene, whose materials are chosen in the picture")


begin = time.monotonic()
with sync_playwright() as playwright, tempfile.TemporaryDirectory() as folder:
    chromium = playwright.chromium.launch(executable_path=browser, args=["--no-sandbox"])
    context = chromium.new_context(viewport={"width": 1440, "height": 900})
    context.set_default_timeout(20000)
    for part in [shader, scene]:
        place = pathlib.Path(folder) / part.__name__
        place.mkdir()
        part(context, place)
    chromium.close()
step("done")
