"""Base of page tests: each has its own browser, and fails on console errors and network requests."""

import subprocess
import sys
import tempfile
import unittest

import browser

# How far the page is wider than its window, in pixels.
WIDER = "return document.documentElement.scrollWidth - innerWidth"


def run(*arguments):
    """A run of the program; some of its cells fail, which is data."""
    return subprocess.run([sys.argv[1], *arguments], check=False, capture_output=True, text=True)


def resized(page, width, height):
    page.call("POST", "/goog/cdp/execute", {  # windows are never so narrow
        "cmd": "Emulation.setDeviceMetricsOverride",
        "params": {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}})


class InBrowser(unittest.TestCase):
    """`made(folder)` of a class writes a page and gives its path."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.address = cls.made(cls.folder.name).as_uri()
        cls.browser = browser.Browser()
        cls.browser.open("about:blank")
        cls.browser.log("performance")

    @classmethod
    def tearDownClass(cls):
        cls.browser.close()
        cls.folder.cleanup()

    def setUp(self):
        resized(self.browser, 1400, 900)

    def tearDown(self):
        self.assertEqual(self.browser.complaints(), [])
        elsewhere = [url for url in self.browser.requests()
                     if not url.startswith(("file:", "data:", "blob:", "chrome:"))]
        self.assertEqual(elsewhere, [], "the page asks the network for something")

    def open(self, rest):
        self.browser.open("about:blank")
        self.browser.open(self.address + rest)
