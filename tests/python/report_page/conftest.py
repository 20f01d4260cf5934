"""A headless browser on pages that `graphdrl report` wrote."""

import html
import json
import os
import pathlib
import re

import make_samples
import pytest
from programs import require_program
from selenium import webdriver

PROGRAM = pathlib.Path(os.environ["GRAPHDRL_BIN"]) / "graphdrl"


class Page:
    """One page in the browser, with short ways to use and to ask it."""

    def __init__(self, driver):
        self.driver = driver

    def js(self, script, *arguments):
        return self.driver.execute_script(script, *arguments)

    def text(self, selector):
        return self.js("return document.querySelector(arguments[0]).textContent.trim()", selector)

    def texts(self, selector):
        return self.js("return [...document.querySelectorAll(arguments[0])].map((e) => e.textContent.trim())", selector)

    def click(self, name):
        self.driver.find_element("id", name).click()

    def choose(self, name, text):
        self.js(
            """const select = document.getElementById(arguments[0]);
            select.value = [...select.options].find((option) => option.text === arguments[1]).value;
            select.dispatchEvent(new Event('change'));""",
            name,
            text,
        )

    def scrub(self, tick):
        self.js(
            "const s = document.getElementById('scrubber'); s.value = arguments[0]; "
            "s.dispatchEvent(new Event('input'));",
            tick,
        )

    def tick(self):
        return int(self.js("return document.getElementById('scrubber').value"))

    def numbers(self, pane=0):
        return self.js(
            """const pane = document.querySelectorAll('.pane')[arguments[0]];
            const read = (name) => pane.querySelector(`.number-${name}`)?.textContent;
            return {step: read('step'), visited: read('visited'), coverage: read('coverage'), cost: read('cost'),
              prize: read('prize')};""",
            pane,
        )

    def settle(self):
        self.driver.execute_async_script(
            "const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(() => done()));"
        )

    def problems(self):
        return self.texts(".problem")

    def complaints(self):
        return [entry["message"] for entry in self.driver.get_log("browser") if entry["level"] in ("WARNING", "SEVERE")]

    def requests(self):
        events = [json.loads(entry["message"])["message"] for entry in self.driver.get_log("performance")]
        urls = [event["params"]["request"]["url"] for event in events if event["method"] == "Network.requestWillBeSent"]
        return [url for url in urls if not url.startswith("data:")]

    # Pixels of a canvas that differ from its first one, as a share.
    def ink(self, selector):
        return self.js(
            """const canvas = document.querySelector(arguments[0]);
            const bytes = new Uint32Array(canvas.getContext('2d')
              .getImageData(0, 0, canvas.width, canvas.height).data.buffer);
            return bytes.filter((pixel) => pixel !== bytes[0]).length / bytes.length;""",
            selector,
        )


@pytest.fixture(scope="session")
def driver():
    chromium = require_program("chromium", "--version", "^Chromium ")
    chromedriver = require_program("chromedriver", "--version", "^ChromeDriver ")
    options = webdriver.ChromeOptions()
    for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--window-size=1280,900"):
        options.add_argument(argument)
    options.binary_location = chromium
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    made = webdriver.Chrome(options=options, service=webdriver.ChromeService(chromedriver))
    yield made
    made.quit()


@pytest.fixture(scope="session")
def assemble(tmp_path_factory):
    """Gives the page that the program writes, with another document, or a text in its place, as its data."""
    folder = tmp_path_factory.mktemp("page")
    (folder / "none.json").write_text('{"rows": [], "overall": []}')
    make_samples.call(PROGRAM, "report", folder / "none.json", "--title", "Report", "--out", folder / "page.html")
    page = (folder / "page.html").read_text(encoding="utf-8")
    element = re.compile(r'(<script type="application/json" id="data">).*?(</script>)', re.DOTALL)
    assert len(element.findall(page)) == 1

    def with_data(text):
        try:
            data = json.loads(text)
        except ValueError:
            data = None
        data = data if isinstance(data, dict) else {}
        made = element.sub(lambda found: found[1] + text.replace("<", "\\u003c") + found[2], page)
        made = made.replace("<title>Report<", f"<title>{html.escape(data.get('title', 'Report'))}<")
        made = made.replace('id="title">Report<', f'id="title">{html.escape(data.get("title", "Report"))}<')
        return made.replace("connect-src 'none'", "connect-src 'self'") if data.get("watch") else made

    return with_data


@pytest.fixture
def show(driver, assemble, tmp_path):
    """Shows a document, or a text in its place, at a window size and in a theme."""

    def show_document(document, width=1280, height=900, dark=False, calm=False):
        text = document if isinstance(document, str) else json.dumps(document)
        path = tmp_path / "page.html"
        path.write_text(assemble(text), encoding="utf-8")
        driver.get("about:blank")
        driver.get_log("browser")
        driver.get_log("performance")
        features = [
            {"name": "prefers-color-scheme", "value": "dark" if dark else "light"},
            {"name": "prefers-reduced-motion", "value": "reduce" if calm else "no-preference"},
        ]
        driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": features})
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500}
        driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
        driver.get(path.as_uri())
        if driver.execute_script("const kept = localStorage.length; localStorage.clear(); return kept;"):
            driver.refresh()
        page = Page(driver)
        page.settle()
        return page

    return show_document


@pytest.fixture(scope="session")
def sample(tmp_path_factory):
    return make_samples.sample(PROGRAM, tmp_path_factory.mktemp("samples"))


@pytest.fixture(scope="session", params=["grid", "graph"])
def large(request):
    replay = make_samples.large_replay(330) if request.param == "grid" else make_samples.large_graph_replay(100000)
    return make_samples.document("Large", [replay])
