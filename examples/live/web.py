"""A web site, explored link by link in a real browser: which pages does it have, and does each link work?

Without an address the site is `shop.py`, with a dead link and one that changes. Needs the package selenium, and the
programs chromium and chromedriver. A page is a state, called by its path; its links within the site are the moves.
Where a link leads to an error the browser goes back, and the move has failed. GraphDRL tries it again later, and gives
it up after the third time. A reset visits the first page. It follows every link: use a site of your own.

    python web.py
    python web.py --url http://127.0.0.1:8000/ --budget 500 --out site.html

Other options go to `graphdrl explore --live`. On a large site give a budget, or only see each page: `--cover nodes`.
"""

import argparse
import os
import shutil
import sys
import urllib.parse

from client import Guide, print_faults
from selenium import webdriver
from selenium.common.exceptions import WebDriverException
from shop import Shop

LINKS = "return [...document.links].map((link) => [link.textContent.trim(), link.href.split('#')[0]])"
STATUS = "return performance.getEntriesByType('navigation')[0]?.responseStatus ?? 0"


def start_browser():
    chromium, driver = shutil.which("chromium"), shutil.which("chromedriver")
    if chromium is None or driver is None:
        sys.exit("there is no chromium, or no chromedriver, on the PATH")
    options = webdriver.ChromeOptions()
    options.binary_location = chromium
    for argument in ["--headless=new", "--disable-gpu"] + ["--no-sandbox"] * (os.geteuid() == 0):
        options.add_argument(argument)
    return webdriver.Chrome(options=options, service=webdriver.ChromeService(driver))


def visit(browser, url):
    """Whether there is such a page."""
    try:
        browser.get(url)
        return 0 < browser.execute_script(STATUS) < 400
    except WebDriverException:
        return False


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--url")
    parser.add_argument("--cover", choices=["edges", "nodes"], default="edges", help="each link, or each page")
    arguments, options = parser.parse_known_args()
    url = arguments.url or Shop().start()
    site, pages, step = urllib.parse.urljoin(url, "/"), set(), {}
    guide = Guide("--cover", arguments.cover, "--reset-cost", "1", *options)
    with start_browser() as browser:
        there = visit(browser, url) or sys.exit(f"{url}: there is no such page")
        while "done" not in step:
            page = browser.current_url
            links = {}  # by text; where two have the same text, one by address
            for text, target in browser.execute_script(LINKS):
                if target.startswith(site) and target not in links.values():
                    links[text if text and text not in links else target] = target
            pages.add(path := "/" + page.split("#")[0].removeprefix(site))
            step = guide.next_step(path, links, failed=not there)
            if "done" not in step:
                there = visit(browser, links[step["move"]] if "move" in step else url)
                if not there:
                    visit(browser, page)
    print(f"{step['done']}: {len(pages)} pages, {step['report']['transitions']} links that work")
    print("pages:", *sorted(pages))
    print_faults(step["report"])


if __name__ == "__main__":
    main()
